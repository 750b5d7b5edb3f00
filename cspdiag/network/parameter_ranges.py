"""Which values the whole-number parameters of each class have: the least and the greatest that any instance is given.

Parameters are set before the network is made (``--set`` as well), so that nothing else can come.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cspdiag.diagnostics.record import replaced
from cspdiag.network.everywhere import rewritten
from cspdiag.network.expressions import ParameterValue
from cspdiag.network.ir import Instantiation, ProcessClass, SubmodelClass


def with_ranges(
    classes: Iterable[ProcessClass | SubmodelClass], instances: Iterable[Instantiation]
) -> tuple[ProcessClass | SubmodelClass, ...]:
    """The classes with the range of each parameter written to where it is used."""
    ranges: dict[tuple[str, str], tuple[int, int]] = {}
    for instance in instances:
        for name, value in instance.arguments:
            if isinstance(value, int) and not isinstance(value, bool):
                low, high = ranges.get((instance.class_name, name), (value, value))
                ranges[instance.class_name, name] = min(low, value), max(high, value)
    return tuple(_with(entry, ranges) for entry in classes)


def _with(
    entry: ProcessClass | SubmodelClass, ranges: dict[tuple[str, str], tuple[int, int]]
) -> ProcessClass | SubmodelClass:
    if not any((entry.name, parameter.name) in ranges for parameter in entry.parameters):
        return entry

    def change(part: Any) -> Any:
        known = ranges.get((entry.name, part.name)) if isinstance(part, ParameterValue) else None
        return part if known is None else replaced(part, range=known)

    return rewritten(entry, change)
