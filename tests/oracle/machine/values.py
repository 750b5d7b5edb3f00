"""The values of expressions, by the sections Types and Expressions of the page."""

from __future__ import annotations

import math
from collections.abc import Mapping

from tests.oracle.programs.tree import (
    Array,
    Bin,
    Bool,
    Call,
    Convert,
    Enum,
    Expr,
    Field,
    If3,
    Index,
    Int,
    Lit,
    Make,
    Now,
    Real,
    Ref,
    Struct,
    Type,
    Un,
    Value,
)  # fmt: skip

NOW = "now"
"""The variable that holds the present instant; no program declares it."""


class FaultError(Exception):
    """Overflow, a value out of range, a division by zero, a function outside its domain."""


def stored(value: Value) -> Value:
    """A value to be stored or written: a real has to be a finite number."""
    for part in value if isinstance(value, tuple) else (value,):
        if isinstance(part, float) and not math.isfinite(part):
            raise FaultError("infinite or not a number")
    return value


def within(value: int | float, kind: Type) -> int | float:
    if isinstance(value, float):
        return value
    assert isinstance(kind, Int)
    low, high = kind.bounds
    if not low <= value <= high:
        raise FaultError(f"{value} is no {kind.name}")
    return value


def _number(value: Value) -> int | float:
    assert isinstance(value, int | float)
    return value


def _converted(value: int | float, kind: Type) -> int | float:
    if isinstance(kind, Real):
        return float(value)
    if not math.isfinite(value):
        raise FaultError(f"{value} is no {kind.name}")
    return within(int(value), kind)


def _called(name: str, numbers: list[int | float]) -> int | float:
    first = numbers[0]
    match name:
        case "limit":
            return numbers[1] if first < numbers[1] else numbers[2] if first > numbers[2] else first
        case "min":
            return min(numbers)
        case "max":
            return max(numbers)
        case "floor":
            return float(math.floor(first)) if math.isfinite(first) else first
        case _:
            if first < 0:
                raise FaultError("the square root of a negative number")
            return math.sqrt(first)


def _arithmetic(op: str, a: int | float, b: int | float) -> int | float:
    real = isinstance(a, float) or isinstance(b, float)
    if real:
        a, b = float(a), float(b)
    match op:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "^":
            return _power(a, b)
        case _:
            if b == 0:
                raise FaultError("division by zero")
            if real:
                return a / b
            quotient = abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)
            return quotient if op == "/" else a - b * quotient


def _power(a: int | float, b: int | float) -> int:
    """A power of whole numbers, without computing one that is far out of range."""
    assert isinstance(a, int)
    assert isinstance(b, int)
    if b < 0 or (abs(a) > 1 and b > 64):
        raise FaultError("a negative exponent, or a power out of range")
    made: int = a ** (2 - b % 2 if abs(a) <= 1 and b else b)
    return made


def evaluate(expr: Expr, variables: Mapping[str, Value]) -> Value:
    match expr:
        case Lit(value):
            return value
        case Ref(name):
            return variables[name]
        case Field(of, position):
            whole = evaluate(of, variables)
            assert isinstance(whole, tuple)
            return whole[position]
        case Index(of, at):
            whole = evaluate(of, variables)
            index = evaluate(at, variables)
            assert isinstance(whole, tuple)
            assert isinstance(index, int)
            if not 0 <= index < len(whole):
                raise FaultError("index out of range")
            return whole[index]
        case Bin(op, left, right, kind):
            return _binary(op, left, right, kind, variables)
        case Un("not", of, _):
            return not evaluate(of, variables)
        case Un(op, of, kind):
            number = _number(evaluate(of, variables))
            return within(abs(number) if op == "abs" else -number, kind)
        case Call(name, arguments, _):
            numbers = [_number(evaluate(argument, variables)) for argument in arguments]
            return _called(name, numbers)
        case Convert(of, kind):
            return _converted(_number(evaluate(of, variables)), kind)
        case If3(condition, yes, no, _):
            return evaluate(yes if evaluate(condition, variables) else no, variables)
        case Now():
            return variables[NOW]
        case Make(inner, _):
            return tuple(evaluate(part, variables) for part in inner)


def nanoseconds(time: int | Expr, variables: Mapping[str, Value]) -> int:
    """A duration or an instant, written or computed."""
    value = time if isinstance(time, int) else evaluate(time, variables)
    assert isinstance(value, int)
    return value


def _binary(op: str, left: Expr, right: Expr, kind: Type, variables: Mapping[str, Value]) -> Value:
    a = evaluate(left, variables)
    if op == "and":
        return bool(a) and bool(evaluate(right, variables))
    if op == "or":
        return bool(a) or bool(evaluate(right, variables))
    b = evaluate(right, variables)
    match op:
        case "==":
            return a == b
        case "!=":
            return a != b
    x, y = _number(a), _number(b)
    match op:
        case "<":
            return x < y
        case "<=":
            return x <= y
        case ">":
            return x > y
        case ">=":
            return x >= y
        case _:
            return within(_arithmetic(op, x, y), kind)


def zero(kind: Type) -> Value:
    """What a port or a variable of this type holds before anything is written."""
    match kind:
        case Int():
            return 0
        case Bool():
            return False
        case Real():
            return 0.0
        case Enum(name, literals):
            return f"{name}.{literals[0]}"
        case Struct(_, fields):
            return tuple(zero(inner) for _, inner in fields)
        case Array(element, size):
            return (zero(element),) * size
