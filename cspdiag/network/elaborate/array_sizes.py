"""Checks sizes of arrays that depend on parameters, and so are known only in a shape."""

from __future__ import annotations

from cspdiag.base import Report, Span
from cspdiag.model.types import ArrayType, Type
from cspdiag.network.diagnostics.arrays import ValueSizesDiffer


def check_sizes(one: Type, other: Type, span: Span, one_name: str, other_name: str, report: Report) -> None:
    """Reports two ends of a communication whose types differ only in the sizes of arrays; the model has reported other
    differences.
    """
    if isinstance(one, ArrayType) and isinstance(other, ArrayType) and one != other and _differ_in_size(one, other):
        report.add(ValueSizesDiffer(span=span, one=one_name, one_type=one, other=other_name, other_type=other))


def _differ_in_size(one: Type, other: Type) -> bool:
    differ = False
    while isinstance(one, ArrayType) and isinstance(other, ArrayType):
        if one.size is None or other.size is None:
            return False
        differ = differ or one.size != other.size
        one, other = one.element, other.element
    return differ and one == other
