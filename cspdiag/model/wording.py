"""The wording of types, of conversions between them and of numbers of things, for messages."""

from __future__ import annotations

from cspdiag.base import Edit, Span
from cspdiag.model.types import IntType, RealType, TimeType, Type
from cspdiag.model.units import SECOND
from cspdiag.syntax import ast


def noun(found: Type) -> str:
    """A type with its article: ``an int``, ``a double<rad>``."""
    return with_article(str(found))


def with_article(text: str) -> str:
    """``an int``, ``a uint8``."""
    return f"an {text}" if text[0] in "aeioAEIO" else f"a {text}"


def counted(number: int, noun: str) -> str:
    """``one state``, ``3 states``."""
    return f"one {noun}" if number == 1 else f"{number} {noun}s"


def waited_for(node: ast.Wait | ast.TimeGuard) -> str:
    """What the expression of a delay or a time guard is: a delay, a time-out or an instant."""
    if isinstance(node, ast.TimeGuard):
        return "instant" if node.at else "time-out"
    return "instant" if node.until else "delay"


def conversion_help(found: Type, expected: Type, written: str) -> str | None:
    """Advice on how to convert ``written``, of type ``found``, to the expected type; None if that is impossible."""
    shown = written if len(written) <= 30 and "\n" not in written else "x"
    match found, expected:
        case RealType(), RealType() if found.unit.exponents == expected.unit.exponents:
            if found.unit.scale != expected.unit.scale:
                return f"write `convert({shown}, {expected.unit})`"
            if found.bits != expected.bits:
                return f"write `{'double' if expected.bits == 64 else 'float'}({shown})`"
        case ((IntType() | RealType()), (IntType() | RealType())):
            if isinstance(expected, RealType) and not expected.unit.is_dimensionless and isinstance(found, IntType):
                return f"write `double({shown}) * 1<{expected.unit}>`"
            if isinstance(found, IntType) or found.unit.is_dimensionless:
                name = str(expected) if isinstance(expected, IntType) else "double" if expected.bits == 64 else "float"
                return f"write `{name}({shown})`"
        case ((IntType() | RealType()), TimeType()) if written.replace(".", "", 1).isdigit():
            return f"write it as a duration, such as `{written} s`"
        case RealType(), TimeType() if found.unit.exponents == SECOND.exponents:
            number, _, unit = written.partition("<")
            plain = number.replace(".", "", 1).isdigit() and unit in {"ns>", "us>", "ms>", "s>", "min>"}
            return f"a duration has no brackets: write `{number} {unit[:-1]}`" if plain else None
        case TimeType(), RealType():
            return f"`double({shown})` is this time in seconds, a double<s>"
        case _:  # No function converts between other types.
            pass
    return None


def conversion(found: Type, expected: Type, span: Span) -> tuple[Edit, ...]:
    """The advice of ``conversion_help`` as an edit, if it keeps the value as precisely as the expected type can."""
    text = span.text
    if "\n" in text:
        return ()
    match found, expected:
        case RealType(), RealType() if found.bits == expected.bits and found.unit.exponents == expected.unit.exponents:
            if found.unit.scale != expected.unit.scale:
                return (Edit(span, f"convert({text}, {expected.unit})"),)
        case IntType(), RealType(bits=64) if expected.unit.is_dimensionless:
            return (Edit(span, f"double({text})"),)
        case IntType(), IntType() if found.bits < expected.bits and (expected.signed or not found.signed):
            return (Edit(span, f"{expected}({text})"),)
        case _:  # Other conversions would lose something.
            pass
    return ()


def to_convert(left: Type, left_span: Span, right: Type, right_span: Span) -> tuple[Type, Type, Span]:
    """Of two values that must agree, the one that should be converted: its type, that of the other, and its place."""
    if _converts_left(left, right):
        return left, right, left_span
    return right, left, right_span


def _converts_left(left: Type, right: Type) -> bool:
    """Whether the left of two values that must agree should be converted: it is narrower, or not in SI units."""
    match left, right:
        case RealType(), RealType() if left.bits == right.bits:
            return left.unit.factor != 1 and right.unit.factor == 1
        case RealType(), RealType():
            return left.bits < right.bits
        case IntType(), IntType():
            return left.bits < right.bits
        case (TimeType(), RealType()) | (IntType(), RealType()):
            return True
        case _:  # Other pairs can only be converted from right to left, if at all.
            return False


def shortened(span: Span) -> str:
    """The source text of a span, or ``x`` if that is long."""
    return span.text if len(span.text) <= 30 and "\n" not in span.text else "x"
