"""The result of a run as JSON: how it ended, and what passed its external ports in figures."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.simulate.record.leaves import leaves
from cspdiag.simulate.record.run_data import histories

if TYPE_CHECKING:
    from cspdiag.simulate.result import Run

Plain = bool | float | int | str
"""A number, a truth value, or the name of a literal; numbers that JSON does not have are texts."""


def result_text(run: Run) -> str:
    """An object; ``ports`` has one for each number of each external port through which something was passed."""
    outcome = run.outcome
    found = {
        "process": run.network.top,
        "environment": None if run.environment is None else run.environment.name,
        "successful": outcome.exit_code == 0,
        "ended": outcome.ended,
        "time": outcome.time / 1e9,
        "error": None if outcome.error is None else described(outcome.error),
        "missed": {port: count for port, count in outcome.missed.items() if count},
        "ports": _figures(run),
    }
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def _figures(run: Run) -> dict[str, Mapping[str, object]]:
    passed = histories(run)
    found: dict[str, Mapping[str, object]] = {}
    for port in run.network.external_ports:
        history = passed.get(f"{run.network.top}.{port.name}")
        if history is not None:
            for name, kind, path in leaves(port.name, port.type):
                values = history.leaf(path, 0, len(history.time))
                found[name] = _of_values(values, kind, event=port.sampling is None)
    return found


def _of_values(values: Sequence[Any], kind: Type, *, event: bool) -> Mapping[str, object]:
    """How many values there were and how often they changed, the least, the greatest and the last. The first value of
    an event port is a change: before there was none.
    """
    changes = sum(one != other for one, other in pairwise(values)) + event
    found: dict[str, object] = {"values": len(values), "changes": changes}
    if isinstance(kind, RealType | IntType | TimeType):
        numbers = [value for value in values if not math.isnan(value)]
        if numbers:
            found |= {"least": _plain(min(numbers), kind), "greatest": _plain(max(numbers), kind)}
    return {**found, "last": _plain(values[-1], kind)}


def _plain(value: Any, kind: Type) -> Plain:
    match kind:
        case EnumType(literals=literals):
            return literals[int(value)]
        case BoolType():
            return bool(value)
        case IntType():
            return int(value)
        case TimeType():
            return int(value) / 1e9
        case RealType():
            return float(value) if math.isfinite(value) else str(float(value))
        case TextType() | UnknownType() | ArrayType() | StructType():
            return str(value)  # Leaves are none of the last two.
        case _:
            assert_never(kind)
