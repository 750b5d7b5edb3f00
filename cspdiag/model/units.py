"""Units of measurement: dimension, scale and spelling.

A unit is the product of powers of the SI base units with a factor. ``rad`` is dimensionless with factor 1 in expressions, but stays
visible in the types of ports. (BIPM, The International System of Units, 9th edition.)
"""

from __future__ import annotations

from typing import ClassVar

from cspdiag.diagnostics.record import record


@record
class Unit:
    """A unit, compared by dimension, scale and whether it is an angle spelled out.

    ``exponents`` are the powers of m, kg, s, A, K, mol, cd, in this order; ``factor`` is the multiple of the coherent SI unit;
    ``text`` is how it was written and takes no part in comparison.
    """

    exponents: tuple[int, ...] = (0, 0, 0, 0, 0, 0, 0)
    factor: float = 1.0
    angle: int = 0
    text: str = ""

    uncompared: ClassVar[frozenset[str]] = frozenset({"text"})

    def __str__(self) -> str:
        return self.text


DIMENSIONLESS = Unit()
