"""Linear plants: states x with ``dx/dt = A x + r``, where A is constant and r is held over a step."""

from __future__ import annotations

from functools import lru_cache
from typing import TypeAlias

Matrix: TypeAlias = "tuple[tuple[float, ...], ...]"
"""The rows of a matrix."""


@lru_cache(maxsize=64)
def rk4_matrices(a: Matrix, h: float) -> tuple[Matrix, Matrix]:
    """M and N, for which one step of the classical Runge-Kutta method over ``h`` seconds is ``x = M x + N r``.

    ``M = I + h A S`` and ``N = h S`` with ``S = I + h A/2 (I + h A/3 (I + h A/4))``. The order of operations is that of
    the language reference, and of C. The matrices are remembered for the lengths of the last steps.
    """
    size = range(len(a))
    z = tuple(tuple(h * entry for entry in row) for row in a)
    s: Matrix = tuple(tuple(1.0 if i == j else 0.0 for j in size) for i in size)
    for divisor in (4.0, 3.0, 2.0):
        s = _plus_one([[entry / divisor for entry in row] for row in _product(z, s)])
    return _plus_one(_product(z, s)), tuple(tuple(h * entry for entry in row) for row in s)


def _product(left: Matrix, right: Matrix) -> list[list[float]]:
    product: list[list[float]] = []
    for row in left:
        product.append([])
        for j in range(len(right)):
            total = 0.0
            for k, factor in enumerate(row):
                total += factor * right[k][j]
            product[-1].append(total)
    return product


def _plus_one(matrix: list[list[float]]) -> Matrix:
    """I + a matrix."""
    return tuple(tuple(1.0 + entry if i == j else entry for j, entry in enumerate(row)) for i, row in enumerate(matrix))
