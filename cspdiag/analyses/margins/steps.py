"""One step of a linear law: its states as rows of coefficients over any basis."""

from __future__ import annotations

from typing import Any

from cspdiag.analyses.margins.law import LinearLaw


def combined(weights: Any, rows: list[Any], zero: Any) -> Any:
    """The weighted sum of some rows."""
    return sum((weight * row for weight, row in zip(weights, rows, strict=True) if weight), zero)


def advanced(law: LinearLaw, row: list[Any], duration: float, zero: Any) -> list[Any]:
    """The states after a sample: discrete ones step, continuous ones follow their derivatives with everything else held
    constant.
    """
    stepped = [combined(weights, row, zero) for weights in law.next]
    if not law.continuous:
        return stepped
    import numpy
    from scipy.linalg import expm  # type: ignore[import-untyped]

    size = len(row)
    generator = numpy.zeros((size, size))
    first = len(law.discrete)
    generator[first : first + len(law.continuous)] = law.rates * duration
    transition = expm(generator)
    moved = transition[first : first + len(law.continuous)]
    return stepped + [combined(weights, row, zero) for weights in moved]
