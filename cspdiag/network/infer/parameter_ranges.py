"""The ranges of the whole-number parameters of each class: the least and the greatest argument of any instance.

Parameters are set before the network is made (also by ``--set``), so no other values are possible.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import ParameterValue, Value
from cspdiag.network.ir.network import CoreClass, Instantiation, SubmodelClass
from cspdiag.network.ir.ranges import Range, joined


def with_ranges(
    classes: Iterable[CoreClass | SubmodelClass], instances: Iterable[Instantiation]
) -> tuple[CoreClass | SubmodelClass, ...]:
    """The classes with the range of each parameter noted wherever the parameter is used."""
    arguments: dict[str, list[Mapping[str, Value]]] = {}
    for instance in instances:
        arguments.setdefault(instance.class_name, []).append(dict(instance.arguments))
    return tuple(_with(entry, ranges_of(arguments.get(entry.name, ()))) for entry in classes)


def ranges_of(instances: Iterable[Mapping[str, Value]]) -> dict[str, Range]:
    """The ranges of the arguments of several instances of one class, by name, for the whole-number parameters to which
    all of them give a value.
    """
    ranges: dict[str, Range] | None = None
    for arguments in instances:
        given = {
            name: value for name, value in arguments.items() if isinstance(value, int) and not isinstance(value, bool)
        }
        if ranges is None:
            ranges = {name: (value, value) for name, value in given.items()}
        else:
            ranges = {name: joined((known, (given[name],) * 2)) for name, known in ranges.items() if name in given}
    return ranges or {}


def _with(entry: CoreClass | SubmodelClass, ranges: Mapping[str, Range]) -> CoreClass | SubmodelClass:
    if not any(parameter.name in ranges for parameter in entry.parameters):
        return entry

    def change(part: Any) -> Any:
        known = ranges.get(part.name) if isinstance(part, ParameterValue) else None
        return part if known is None else replaced(part, range=known)

    return rewritten(entry, change)
