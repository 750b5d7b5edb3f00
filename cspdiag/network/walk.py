"""Looks through actions and expressions."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.diagnostics.record import field_names, is_record
from cspdiag.network.actions import Action, RunInstance
from cspdiag.network.expressions import Expression, VariableValue


def parts(item: object) -> Iterator[object]:
    """Every record in a record or in a tuple or list of them, itself first, in the order of the text; places and types are left out."""
    pending: list[object] = [item]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple | list):
            pending.extend(reversed(part))
        elif is_record(part):
            yield part
            pending.extend(getattr(part, name) for name in reversed(field_names(part)) if name not in ("span", "type"))


def instances_run(action: Action) -> list[str]:
    """The instances that an action runs, in text order."""
    return [part.instance for part in parts(action) if isinstance(part, RunInstance)]


def mentions_variable(expression: Expression) -> bool:
    """Whether an expression depends on a variable of the process."""
    return any(isinstance(part, VariableValue) for part in parts(expression))
