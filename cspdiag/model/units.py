"""Units of measurement: dimension, scale and spelling.

A unit is the product of powers of the SI base units with a factor. ``rad`` is dimensionless with factor 1 in expressions, but stays
visible in the types of ports. (BIPM, The International System of Units, 9th edition.)
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import ClassVar

from cspdiag.diagnostics.record import record


@record
class Unit:
    """A unit, compared by dimension, scale and whether it is an angle spelled out.

    ``exponents`` are the powers of m, kg, s, A, K, mol, cd, in this order; ``factor`` is the multiple of the coherent SI unit;
    ``angle`` is the power of the angle that was spelled out (1 for ``rad/s``); ``text`` is how it was written and takes no part in
    comparison.
    """

    exponents: tuple[int, ...] = (0, 0, 0, 0, 0, 0, 0)
    factor: float = 1.0
    angle: int = 0
    text: str = ""

    uncompared: ClassVar[frozenset[str]] = frozenset({"text"})

    @property
    def is_dimensionless(self) -> bool:
        """Whether this is a number, an angle or a ratio."""
        return not any(self.exponents)

    def __str__(self) -> str:
        return self.text or "1"


DIMENSIONLESS = Unit()

_BASE_SYMBOLS = ("m", "kg", "s", "A", "K", "mol", "cd")

_PREFIXES = {
    "Y": 1e24, "Z": 1e21, "E": 1e18, "P": 1e15, "T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2, "da": 1e1,
    "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15, "a": 1e-18, "z": 1e-21, "y": 1e-24,
}  # fmt: skip

_PREFIXED: dict[str, tuple[tuple[int, ...], float, int]] = {
    "m": ((1, 0, 0, 0, 0, 0, 0), 1.0, 0),
    "g": ((0, 1, 0, 0, 0, 0, 0), 1e-3, 0),
    "s": ((0, 0, 1, 0, 0, 0, 0), 1.0, 0),
    "A": ((0, 0, 0, 1, 0, 0, 0), 1.0, 0),
    "K": ((0, 0, 0, 0, 1, 0, 0), 1.0, 0),
    "mol": ((0, 0, 0, 0, 0, 1, 0), 1.0, 0),
    "cd": ((0, 0, 0, 0, 0, 0, 1), 1.0, 0),
    "rad": ((0, 0, 0, 0, 0, 0, 0), 1.0, 1),
    "Hz": ((0, 0, -1, 0, 0, 0, 0), 1.0, 0),
    "N": ((1, 1, -2, 0, 0, 0, 0), 1.0, 0),
    "Pa": ((-1, 1, -2, 0, 0, 0, 0), 1.0, 0),
    "bar": ((-1, 1, -2, 0, 0, 0, 0), 1e5, 0),
    "J": ((2, 1, -2, 0, 0, 0, 0), 1.0, 0),
    "Wh": ((2, 1, -2, 0, 0, 0, 0), 3600.0, 0),
    "W": ((2, 1, -3, 0, 0, 0, 0), 1.0, 0),
    "C": ((0, 0, 1, 1, 0, 0, 0), 1.0, 0),
    "V": ((2, 1, -3, -1, 0, 0, 0), 1.0, 0),
    "F": ((-2, -1, 4, 2, 0, 0, 0), 1.0, 0),
    "Ohm": ((2, 1, -3, -2, 0, 0, 0), 1.0, 0),
    "S": ((-2, -1, 3, 2, 0, 0, 0), 1.0, 0),
    "Wb": ((2, 1, -2, -1, 0, 0, 0), 1.0, 0),
    "T": ((0, 1, -2, -1, 0, 0, 0), 1.0, 0),
    "H": ((2, 1, -2, -2, 0, 0, 0), 1.0, 0),
    "l": ((3, 0, 0, 0, 0, 0, 0), 1e-3, 0),
    "L": ((3, 0, 0, 0, 0, 0, 0), 1e-3, 0),
}

_UNPREFIXED: dict[str, tuple[tuple[int, ...], float, int]] = {
    "deg": ((0, 0, 0, 0, 0, 0, 0), math.pi / 180, 1),
    "rev": ((0, 0, 0, 0, 0, 0, 0), math.tau, 1),
    "rpm": ((0, 0, -1, 0, 0, 0, 0), math.tau / 60, 1),
    "min": ((0, 0, 1, 0, 0, 0, 0), 60.0, 0),
    "h": ((0, 0, 1, 0, 0, 0, 0), 3600.0, 0),
    "day": ((0, 0, 1, 0, 0, 0, 0), 86400.0, 0),
    "t": ((0, 1, 0, 0, 0, 0, 0), 1e3, 0),
    "%": ((0, 0, 0, 0, 0, 0, 0), 0.01, 0),
}

_NAMED = ("Hz", "N", "J", "W", "C", "V", "F", "Ohm", "Wb", "T", "H", "Pa")
"""Coherent derived units that a long product may be printed as."""

_TOKEN = re.compile(r"\s*(?:([A-Za-z]+|%|1(?![0-9]))(?:\s*\^\s*(-?\s*[0-9]{1,3}))?|([*/()]))")
_LONGEST = 200


@cache
def _symbol(text: str) -> tuple[tuple[int, ...], float, int] | None:
    if text == "1":
        return DIMENSIONLESS.exponents, 1.0, 0
    found = _UNPREFIXED.get(text) or _PREFIXED.get(text)
    if found:
        return found
    for length in (1, 2):
        scale, base = _PREFIXES.get(text[:length]), _PREFIXED.get(text[length:])
        if scale and base:
            return base[0], _rounded(scale * base[1]), base[2]
    return None


def _rounded(factor: float) -> float:
    """Twelve digits, so that factors reached in different ways compare equal."""
    return float(f"{factor:.12g}")


@cache
def parse_unit(text: str) -> Unit | None:
    """The unit that ``text`` spells (``kg*m^2``, ``N*m*s/rad``, ``J/(kg*K)``, ``1/s``); None if it is none.

    ``/`` divides by the factor (or the parenthesis) that follows it only.
    """
    if len(text) > _LONGEST:
        return None
    powers: dict[str, int] = {}
    signs = [1]
    sign, expects_factor, at = 1, True, 0
    while at < len(text.rstrip()):
        token = _TOKEN.match(text, at)
        if token is None:
            return None
        at = token.end()
        symbol, power, mark = token.groups()
        if symbol:
            if not expects_factor or _symbol(symbol) is None:
                return None
            powers[symbol] = powers.get(symbol, 0) + sign * int((power or "1").replace(" ", ""))
            expects_factor = False
        elif mark == "(":
            if not expects_factor:
                return None
            signs.append(sign)
        elif expects_factor:
            return None
        elif mark == ")":
            if len(signs) == 1:
                return None
            signs.pop()
            continue
        else:
            expects_factor = True
        sign = -signs[-1] if mark == "/" else signs[-1]
    if expects_factor or len(signs) > 1:
        return None
    return _of_powers(powers, text.strip())


def _of_powers(powers: dict[str, int], text: str) -> Unit | None:
    exponents, factor, angle = [0] * 7, 1.0, 0
    try:
        for name, power in powers.items():
            base = _symbol(name)
            if base is None:
                return None
            for position, exponent in enumerate(base[0]):
                exponents[position] += power * exponent
            factor *= base[1] ** power
            angle += power * base[2]
    except OverflowError:
        return None
    if not 0 < factor < math.inf:
        return None
    return Unit(tuple(exponents), _rounded(factor), angle, "" if text == "1" else text)


def multiply(left: Unit, right: Unit) -> Unit:
    """The product of two units."""
    return _combined(left, left.text, right, right.text, 1)


def divide(left: Unit, right: Unit) -> Unit:
    """The quotient of two units."""
    return _combined(left, left.text, right, right.text, -1)


@cache
def _combined(left: Unit, left_text: str, right: Unit, right_text: str, sign: int) -> Unit:
    exponents = tuple(a + sign * b for a, b in zip(left.exponents, right.exponents, strict=True))
    factor = _rounded(_bounded(left.factor * _bounded(right.factor**sign)))
    powers = _powers(left_text)
    for name, power in _powers(right_text).items():
        powers[name] = powers.get(name, 0) + sign * power
    return _spelled(Unit(exponents, factor, left.angle + sign * right.angle), powers)


def power(unit: Unit, numerator: int, denominator: int = 1) -> Unit | None:
    """``unit`` to a rational power; None where a base unit would get a broken one, as in the square root of a metre."""
    if unit == DIMENSIONLESS:
        return DIMENSIONLESS
    if any(exponent * numerator % denominator for exponent in unit.exponents):
        return None
    exponents = tuple(exponent * numerator // denominator for exponent in unit.exponents)
    try:
        factor = _rounded(_bounded(unit.factor ** (numerator / denominator)))
    except OverflowError:
        return None
    # Half an angle is a number: an angle is dimensionless, so that its square root is allowed.
    angle = 0 if unit.angle * numerator % denominator else unit.angle * numerator // denominator
    powers = _powers(unit.text)
    if any(value * numerator % denominator for value in powers.values()):
        powers = {}
    return _spelled(
        Unit(exponents, factor, angle), {name: value * numerator // denominator for name, value in powers.items()}
    )


def _bounded(factor: float) -> float:
    return min(max(factor, 1e-300), 1e300)


def _powers(text: str) -> dict[str, int]:
    """The factors of a unit's spelling that has no parentheses; those of one that has are not told apart."""
    powers: dict[str, int] = {}
    sign = 1
    if "(" in text:
        unit = parse_unit(text)
        text = _base_text(unit.exponents) if unit else ""
    for symbol, exponent, mark in _TOKEN.findall(text):
        if symbol and symbol != "1":
            powers[symbol] = powers.get(symbol, 0) + sign * int((exponent or "1").replace(" ", ""))
        sign = -1 if mark == "/" else 1
    return powers


def _spelled(unit: Unit, powers: dict[str, int]) -> Unit:
    """``unit`` with a spelling: its factors, or where these are many a name or the base units."""
    powers = {name: power for name, power in powers.items() if power}
    text = _product(powers)
    spelled = _of_powers(powers, text)
    if len(powers) > 3 or spelled != unit:
        shorter = [name for name in _NAMED if _PREFIXED[name][0] == unit.exponents]
        text = shorter[0] if shorter else _base_text(unit.exponents)
        if unit.factor != 1:
            text = f"{unit.factor:g}*{text}" if text else f"{unit.factor:g}"
    return Unit(unit.exponents, unit.factor, unit.angle, text)


def _base_text(exponents: tuple[int, ...]) -> str:
    return _product(dict(zip(_BASE_SYMBOLS, exponents, strict=True)))


def _product(powers: dict[str, int]) -> str:
    def factor(name: str, power: int) -> str:
        return name if power == 1 else f"{name}^{power}"

    above = "*".join(factor(name, power) for name, power in powers.items() if power > 0)
    below = "".join("/" + factor(name, -power) for name, power in powers.items() if power < 0)
    return (above or "1") + below if above or below else ""


def agree(left: Unit, right: Unit) -> bool:
    """Whether two quantities may be added: dimension and scale are equal; ``rad`` counts as 1."""
    return left.exponents == right.exponents and left.factor == right.factor


def same_dimension(left: Unit, right: Unit) -> bool:
    """Whether one can be converted to the other."""
    return left.exponents == right.exponents


def conversion_factor(source: Unit, target: Unit) -> float | None:
    """What a number in ``source`` is multiplied by to be one in ``target``; None where the dimensions differ.

    >>> conversion_factor(parse_unit("deg"), parse_unit("rad"))
    0.0174532925199433
    """
    return source.factor / target.factor if source.exponents == target.exponents else None


def canonical(unit: Unit) -> str:
    """A spelling of a unit's coherent SI counterpart, for help texts: ``rad`` for ``deg``, ``m/s`` for ``km/h``."""
    if unit.factor == 1 and unit.text:
        return unit.text
    if unit.is_dimensionless:
        return "rad" if unit.angle else "1"
    text = _base_text(unit.exponents)
    return text


SECOND = Unit((0, 0, 1, 0, 0, 0, 0), 1.0, 0, "s")
HERTZ = Unit((0, 0, -1, 0, 0, 0, 0), 1.0, 0, "Hz")
PER_SECOND = Unit((0, 0, -1, 0, 0, 0, 0), 1.0, 0, "1/s")
