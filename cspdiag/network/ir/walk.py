"""Looks through actions and expressions."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import field_names, is_record
from cspdiag.network.ir.actions import Action, RunInstance
from cspdiag.network.ir.expressions import Expression, PresentTime, VariableValue


def parts(item: object) -> Iterator[object]:
    """Every record in a record or in a tuple or list of them, itself first, in the order of the text; places and types
    are left out.
    """
    pending: list[object] = [item]
    while pending:
        part = pending.pop()
        names = _INSIDE.get(type(part))
        if names is None:
            names = _INSIDE[type(part)] = _names_inside(part)
        if names:
            yield part
            for name in names:
                inner = getattr(part, name)
                if inner is not None:
                    pending.append(inner)
        elif isinstance(part, tuple | list):
            pending.extend(reversed(part))
        elif is_record(part):
            yield part


_INSIDE: dict[type, tuple[str, ...]] = {}
"""By type, the fields that are looked into, the last one first: networks have millions of parts."""


def _names_inside(part: object) -> tuple[str, ...]:
    if not is_record(part):
        return ()
    annotations = {
        name: kind for cls in type(part).__mro__ for name, kind in getattr(cls, "__annotations__", {}).items()
    }
    names = (name for name in field_names(part) if name not in ("span", "type") and annotations[name] not in _ATOMS)
    return tuple(names)[::-1]


_ATOMS = frozenset({"str", "str | None", "int", "int | None", "bool"})


def instances_run(action: Action) -> list[str]:
    """The instances that an action runs, in text order."""
    return [part.instance for part in parts(action) if isinstance(part, RunInstance)]


def mentions_variable(expression: Expression) -> bool:
    """Whether an expression depends on a variable of the process, or on the present instant."""
    return any(isinstance(part, VariableValue | PresentTime) for part in parts(expression))
