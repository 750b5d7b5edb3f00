"""Units of measurement: dimension, scale and spelling.

A unit is the product of powers of the SI base units with a factor. ``rad`` is dimensionless with factor 1 in
expressions, but stays visible in the types of ports. (BIPM, The International System of Units, 9th edition.)
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import ClassVar

from cspdiag.base.record import record
from cspdiag.base.spelling import near_symbol


@record
class Unit:
    """A unit, compared by dimension, scale and whether it is an angle spelled out.

    ``exponents`` are the powers of m, kg, s, A, K, mol, cd, in this order; the scale is exactly
    ``numerator / denominator * pi**pi_power`` times the coherent SI unit; ``angle`` is the power of the angle that was
    spelled out (1 for ``rad/s``); ``text`` is the spelling, which is not compared.
    """

    exponents: tuple[int, ...] = (0, 0, 0, 0, 0, 0, 0)
    numerator: int = 1
    denominator: int = 1
    pi_power: int = 0
    angle: int = 0
    text: str = ""

    uncompared: ClassVar[frozenset[str]] = frozenset({"text"})

    @property
    def factor(self) -> float:
        """The multiple of the coherent SI unit."""
        return self.numerator * math.pi**self.pi_power / self.denominator

    @property
    def scale(self) -> tuple[int, int, int]:
        """The factor, exactly: numerator, denominator, power of pi."""
        return self.numerator, self.denominator, self.pi_power

    @property
    def is_dimensionless(self) -> bool:
        """Whether this is a number, an angle or a ratio."""
        return not any(self.exponents)

    def __str__(self) -> str:
        return self.text or "1"


DIMENSIONLESS = Unit()

_BASE_SYMBOLS = ("m", "kg", "s", "A", "K", "mol", "cd")

_PREFIXES = {
    "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "d": -1, "c": -2, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
}  # fmt: skip


def _unit(*exponents: int, numerator: int = 1, denominator: int = 1, pi_power: int = 0, angle: int = 0) -> Unit:
    return Unit((*exponents, *(0,) * (7 - len(exponents))), numerator, denominator, pi_power, angle)


_PREFIXED = {
    "m": _unit(1),
    "g": _unit(0, 1, denominator=1000),
    "s": _unit(0, 0, 1),
    "A": _unit(0, 0, 0, 1),
    "K": _unit(0, 0, 0, 0, 1),
    "mol": _unit(0, 0, 0, 0, 0, 1),
    "cd": _unit(0, 0, 0, 0, 0, 0, 1),
    "rad": _unit(angle=1),
    "Hz": _unit(0, 0, -1),
    "N": _unit(1, 1, -2),
    "Pa": _unit(-1, 1, -2),
    "bar": _unit(-1, 1, -2, numerator=100_000),
    "J": _unit(2, 1, -2),
    "Wh": _unit(2, 1, -2, numerator=3600),
    "W": _unit(2, 1, -3),
    "C": _unit(0, 0, 1, 1),
    "V": _unit(2, 1, -3, -1),
    "F": _unit(-2, -1, 4, 2),
    "Ohm": _unit(2, 1, -3, -2),
    "S": _unit(-2, -1, 3, 2),
    "Wb": _unit(2, 1, -2, -1),
    "T": _unit(0, 1, -2, -1),
    "H": _unit(2, 1, -2, -2),
    "l": _unit(3, denominator=1000),
    "L": _unit(3, denominator=1000),
}

_UNPREFIXED = {
    "1": DIMENSIONLESS,
    "deg": _unit(denominator=180, pi_power=1, angle=1),
    "rev": _unit(numerator=2, pi_power=1, angle=1),
    "rpm": _unit(0, 0, -1, denominator=30, pi_power=1, angle=1),
    "min": _unit(0, 0, 1, numerator=60),
    "h": _unit(0, 0, 1, numerator=3600),
    "day": _unit(0, 0, 1, numerator=86_400),
    "t": _unit(0, 1, numerator=1000),
    "%": _unit(denominator=100),
}

_NAMED = ("Hz", "N", "J", "W", "C", "V", "F", "Ohm", "Wb", "T", "H", "Pa")
"""Coherent derived units, as shorter spellings of long products."""

_HABITS = {
    "Nm": "N*m", "Nms": "N*m*s", "kgm2": "kg*m^2", "kgm^2": "kg*m^2", "ohm": "Ohm", "degree": "deg",
    "degrees": "deg",
    "radian": "rad", "radians": "rad", "rads": "rad", "sec": "s", "hz": "Hz", "volt": "V", "v": "V", "Volt": "V",
    "Ampere": "A", "meter": "m", "metre": "m", "rps": "rev/s", "turn": "rev", "RPM": "rpm", "percent": "1",
    "Newton": "N", "Watt": "W", "Kg": "kg", "KG": "kg", "sec^2": "s^2",
}  # fmt: skip
"""Common other spellings of units."""

_TOKEN = re.compile(r"\s*(?:([A-Za-z]+|%|1(?![0-9]))(?:\s*\^\s*(-?\s*[0-9]{1,3}))?|([*/()]))")
_LONGEST = 200


@cache
def _symbol(text: str) -> Unit | None:
    found = _UNPREFIXED.get(text) or _PREFIXED.get(text)
    if found:
        return found
    for length in (1, 2):
        scale, base = _PREFIXES.get(text[:length]), _PREFIXED.get(text[length:])
        if scale and base:
            prefix = (10**scale, 1) if scale > 0 else (1, 10**-scale)
            return _scaled(base.exponents, base.numerator * prefix[0], base.denominator * prefix[1], 0, base.angle)
    return None


def _scaled(exponents: tuple[int, ...], numerator: int, denominator: int, pi_power: int, angle: int) -> Unit:
    common = math.gcd(numerator, denominator)
    return Unit(exponents, numerator // common, denominator // common, pi_power, angle)


@cache
def parse_unit(text: str) -> Unit | None:
    """The unit with the spelling ``text`` (``kg*m^2``, ``N*m*s/rad``, ``J/(kg*K)``, ``1/s``); None if it is not a unit.
    ``/`` divides only by the factor or the parenthesis that follows it.
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
    unit = DIMENSIONLESS
    for name, exponent in powers.items():
        base = _symbol(name)
        raised = _raised(base, exponent, 1) if base else None
        if raised is None:
            return None
        unit = _product(unit, raised, 1)
    return Unit(*_compared_fields(unit), "" if text == "1" else text) if _has_usable_scale(unit) else None


def unit_names() -> tuple[str, ...]:
    """The names of units without a prefix, those that are written most first."""
    return (*_PREFIXED, *_UNPREFIXED)


def near_unit(text: str) -> str | None:
    """The unit that was probably meant by an unknown one; None if there is no likely one."""
    if text in _HABITS:
        return _HABITS[text]
    symbols = [*_NAMED, *_UNPREFIXED, *_PREFIXED]

    def meant(match: re.Match[str]) -> str:
        return match[0] if _symbol(match[0]) else near_symbol(match[0], symbols) or match[0]

    near = re.sub("[A-Za-z]+", meant, text[:_LONGEST])
    return near if near != text and parse_unit(near) is not None else None


def _compared_fields(unit: Unit) -> tuple[tuple[int, ...], int, int, int, int]:
    return unit.exponents, unit.numerator, unit.denominator, unit.pi_power, unit.angle


def _has_usable_scale(unit: Unit) -> bool:
    """Whether the scale is far inside the range of a double."""
    return max(unit.numerator.bit_length(), unit.denominator.bit_length()) < 900 and abs(unit.pi_power) < 100


def multiply(left: Unit, right: Unit) -> Unit:
    """The product of two units."""
    return _combined(left, left.text, right, right.text, 1)


def divide(left: Unit, right: Unit) -> Unit:
    """The quotient of two units."""
    return _combined(left, left.text, right, right.text, -1)


@cache
def _combined(left: Unit, left_text: str, right: Unit, right_text: str, sign: int) -> Unit:
    product = _product(left, right, sign)
    if not _has_usable_scale(product):
        product = Unit(product.exponents)
    powers = _powers(left_text)
    for name, exponent in _powers(right_text).items():
        powers[name] = powers.get(name, 0) + sign * exponent
    return _spelled(product, powers)


def _product(left: Unit, right: Unit, sign: int) -> Unit:
    exponents = tuple(a + sign * b for a, b in zip(left.exponents, right.exponents, strict=True))
    above, below = (right.numerator, right.denominator) if sign > 0 else (right.denominator, right.numerator)
    pi_power, angle = left.pi_power + sign * right.pi_power, left.angle + sign * right.angle
    return _scaled(exponents, left.numerator * above, left.denominator * below, pi_power, angle)


def power(unit: Unit, exponent: int, root: int = 1) -> Unit | None:
    """The ``root``-th root of ``unit`` to the power ``exponent``.

    None if a base unit would get a fractional exponent, as in the square root of a metre, or if the scale would not be
    exact.
    """
    raised = _raised(unit, exponent, root)
    if raised is None or not _has_usable_scale(raised):
        return None
    powers = _powers(unit.text)
    if any(value * exponent % root for value in powers.values()):
        powers = {}
    return _spelled(raised, {name: value * exponent // root for name, value in powers.items()})


def _raised(unit: Unit, exponent: int, root: int) -> Unit | None:
    if abs(exponent) > 100 or any(value * exponent % root for value in (*unit.exponents, unit.pi_power)):
        return None
    numerator, denominator = _root(unit.numerator, root), _root(unit.denominator, root)
    if numerator is None or denominator is None:
        return None
    if exponent < 0:
        numerator, denominator = denominator, numerator
    exponents = tuple(value * exponent // root for value in unit.exponents)
    # An angle is a number, so its square root is a number, too.
    angle = 0 if unit.angle * exponent % root else unit.angle * exponent // root
    size = abs(exponent)
    return _scaled(exponents, numerator**size, denominator**size, unit.pi_power * exponent // root, angle)


def _root(number: int, root: int) -> int | None:
    if root == 1 or number == 1:
        return number
    near = round(number ** (1 / root)) if number.bit_length() < 1000 else 0
    return near if near**root == number else None


def _powers(text: str) -> dict[str, int]:
    """The factors in the spelling of a unit; for a spelling with parentheses, the base units."""
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
    """``unit`` with a spelling: its factors or, if there are many, a name or the base units."""
    powers = {name: power for name, power in powers.items() if power}
    text = _written(powers)
    spelled = _of_powers(powers, text)
    if len(powers) > 3 or spelled != unit:
        shorter = [name for name in _NAMED if _PREFIXED[name].exponents == unit.exponents]
        text = shorter[0] if shorter else _base_text(unit.exponents)
        if unit.factor != 1:
            text = f"{unit.factor:g}*{text}" if text else f"{unit.factor:g}"
    return Unit(*_compared_fields(unit), text)


def _base_text(exponents: tuple[int, ...]) -> str:
    return _written(dict(zip(_BASE_SYMBOLS, exponents, strict=True)))


def _written(powers: dict[str, int]) -> str:
    def factor(name: str, power: int) -> str:
        return name if power == 1 else f"{name}^{power}"

    above = "*".join(factor(name, power) for name, power in powers.items() if power > 0)
    below = "".join("/" + factor(name, -power) for name, power in powers.items() if power < 0)
    return (above or "1") + below if above or below else ""


def agree(left: Unit, right: Unit) -> bool:
    """Whether two quantities may be added: dimension and scale are equal; ``rad`` counts as 1."""
    return left.exponents == right.exponents and left.scale == right.scale


def same_dimension(left: Unit, right: Unit) -> bool:
    """Whether one can be converted to the other."""
    return left.exponents == right.exponents


def conversion_factor(source: Unit, target: Unit) -> float | None:
    """The factor that converts a number in ``source`` to one in ``target``; None if the dimensions differ.

    >>> conversion_factor(parse_unit("deg"), parse_unit("rad"))
    0.017453292519943295
    """
    return _product(source, target, -1).factor if source.exponents == target.exponents else None


def canonical(unit: Unit) -> str:
    """The spelling of the coherent SI unit of the same dimension, for help texts: ``rad`` for ``deg``, ``m/s`` for
    ``km/h``.
    """
    if unit.factor == 1 and unit.text:
        return unit.text
    if unit.is_dimensionless:
        return "rad" if unit.angle else "1"
    return _base_text(unit.exponents)


SECOND = Unit((0, 0, 1, 0, 0, 0, 0), text="s")
HERTZ = Unit((0, 0, -1, 0, 0, 0, 0), text="Hz")
