"""What a program remembers: variables, states of control laws, contents of buffers."""

from __future__ import annotations

from typing import Any

from cspdiag.runtime.channels.buffers import Buffer
from cspdiag.runtime.channels.variable import Variable
from cspdiag.runtime.kernel.exceptions import Fault
from cspdiag.runtime.process import Process, Submodel

_OF_THE_RUNTIME = frozenset({"name", "source", "runs_now", "enclosing", "ends", "has_computed"})


def memory(outermost: Any) -> dict[str, object]:
    """The value of everything that a process and those inside it remember, by name; for a buffer, the values in it."""
    found: dict[str, object] = {}
    seen: set[int] = set()
    pending: list[Any] = [outermost]
    while pending:
        part = pending.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        if isinstance(part, list | tuple):
            pending += part
        elif isinstance(part, Variable):
            found[part.name] = _value(part)
        elif isinstance(part, Buffer):
            found[part.name] = tuple(part._stored)
        elif isinstance(part, Process):
            for name, value in vars(part).items():
                if name in _OF_THE_RUNTIME:
                    continue
                if isinstance(part, Submodel) and isinstance(value, bool | int | float | str | tuple):
                    found[f"{part.name}.{name}"] = value
                else:
                    pending.append(value)
    return found


def _value(variable: Variable[Any]) -> object:
    """The value of a variable; None before it was written."""
    try:
        return variable.value
    except Fault:
        return None
