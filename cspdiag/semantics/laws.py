"""A reference interpreter for submodels of the network: slow, plain, and independent of the compiler's arithmetic.

It is what generated code is compared with. Values are Python's bool, int, float and tuples; ``float`` (binary32) is rounded
after every operation; what the language calls a fault raises ``FaultError``.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from typing import Any, assert_never

from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, TimeType, Type
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.network import SubmodelClass


class FaultError(Exception):
    """An overflow, a division by zero, an index out of range."""


def checked(kind: Type, value: Any) -> Any:
    """A result as a value of its type."""
    if isinstance(kind, IntType | TimeType):
        low, high = (kind.minimum, kind.maximum) if isinstance(kind, IntType) else (-(2**63), 2**63 - 1)
        if not low <= value <= high:
            raise FaultError(f"{value} is not a value of {kind}")
        return int(value)
    if isinstance(kind, RealType) and kind.bits == 32:
        return struct.unpack("f", struct.pack("f", value))[0]
    return value


class Interpreter:
    """One instance of a submodel class. ``parameters`` has values for all parameters, derived ones too."""

    def __init__(
        self, cls: SubmodelClass, parameters: Mapping[str, Any], externals: Mapping[str, Any] | None = None
    ) -> None:
        self.cls = cls
        self.parameters = dict(parameters)
        self.externals = dict(externals or {})
        self.time = 0.0
        self.constants: dict[str, Any] = {}
        for constant in cls.constants:
            self.constants[constant.name] = self.value(constant.value, self.constants)
        self.states: dict[str, Any] = {}
        self.reset()

    def reset(self) -> None:
        """Put the states back to their initial values."""
        for state in self.cls.states:
            self.states[state.name] = self.value(state.initial, self.constants)

    def evaluate(self, **inputs: Any) -> dict[str, Any]:
        """All signals at the present instant."""
        signals = {**self.constants, **inputs, **self.states}
        for equation in self.cls.equations:
            if isinstance(equation, ExternalCall):
                given = {name: self.value(value, signals) for name, value in equation.inputs}
                results = self.externals[equation.name](**given)
                results = results if isinstance(results, tuple) else (results,)
                for (_, local, _), result in zip(equation.outputs, results, strict=True):
                    signals[local] = result
            else:
                signals[equation.name] = self.value(equation.value, signals)
        return signals

    def advance(self, signals: dict[str, Any], duration: float, *, discrete: bool = True) -> None:
        """From one sample to the next: integrates over ``duration`` in seconds and takes the next values."""
        following = {name: self.value(value, signals) for name, value in self.cls.next_values} if discrete else {}
        if self.cls.derivatives:
            following.update({name: _finite(value) for name, value in self._integrated(signals, duration).items()})
        self.states.update(following)
        self.time += duration

    def sample(self, **inputs: Any) -> dict[str, Any]:
        """One run of a sampled submodel, with the inputs held; gives all signals."""
        signals = self.evaluate(**inputs)
        self.advance(signals, self.parameters.get("sample", self.constants.get("sample", 0.0)))
        return signals

    def _integrated(self, signals: dict[str, Any], duration: float) -> dict[str, float]:
        steps = 1
        if self.cls.step is not None:
            steps = max(1, math.ceil(round(duration * 1e9) / self.cls.step))
        h = duration / steps
        names = [name for name, _ in self.cls.derivatives]
        x = {name: signals[name] for name in names}
        began = self.time
        for step in range(steps):
            t = began + step * h

            def slope(
                shift: float, k: Mapping[str, float] | None, x: dict[str, float] = x, t: float = t
            ) -> dict[str, float]:
                moved = {name: x[name] + shift * (k[name] if k else 0.0) for name in names}
                return self._derivatives({**signals, **moved}, t + shift)

            k1 = slope(0.0, None)
            if self.cls.method == "euler":
                x = {name: x[name] + h * k1[name] for name in names}
                continue
            k2 = slope(h / 2, k1)
            k3 = slope(h / 2, k2)
            k4 = slope(h, k3)
            x = {n: x[n] + h / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n]) for n in names}
        self.time = began
        return x

    def _derivatives(self, signals: dict[str, Any], time: float) -> dict[str, float]:
        self.time = time
        for equation in self.cls.derivative_equations:
            signals[equation.name] = self.value(equation.value, signals)
        return {name: self.value(value, signals) for name, value in self.cls.derivatives}

    def value(self, expression: Expression, signals: Mapping[str, Any]) -> Any:
        """The value of an expression."""
        match expression:
            case LiteralValue():
                return expression.value
            case ParameterValue():
                return self.parameters[expression.name]
            case SignalValue():
                return signals[expression.name]
            case VariableValue():
                raise AssertionError("a submodel has no variables")
            case PresentTime():
                return self.time
            case UnaryOperation():
                operand = self.value(expression.operand, signals)
                return checked(expression.type, -operand) if expression.operator == "-" else not operand
            case BinaryOperation():
                return self._binary(expression, signals)
            case ConditionalValue():
                chosen = expression.then if self.value(expression.condition, signals) else expression.otherwise
                return self.value(chosen, signals)
            case FunctionCall():
                arguments = [self.value(argument, signals) for argument in expression.arguments]
                return checked(expression.type, FUNCTIONS[expression.function](*arguments))
            case Conversion():
                operand = self.value(expression.operand, signals)
                if isinstance(expression.type, RealType):
                    return checked(expression.type, float(operand))
                if isinstance(operand, float) and not math.isfinite(operand):
                    raise FaultError("not a number")
                return checked(expression.type, math.trunc(operand))
            case FieldValue():
                assert isinstance(expression.operand.type, StructType)
                names = [name for name, _ in expression.operand.type.fields]
                return self.value(expression.operand, signals)[names.index(expression.field)]
            case ElementValue():
                array, index = self.value(expression.operand, signals), self.value(expression.index, signals)
                if not 0 <= index < len(array):
                    raise FaultError("index out of range")
                return array[index]
            case StructValue() | ArrayElements():
                return tuple(self.value(part, signals) for part in expression.values)
            case _:
                assert_never(expression)

    def _binary(self, expression: BinaryOperation, signals: Mapping[str, Any]) -> Any:
        left = self.value(expression.left, signals)
        if expression.operator == "and":
            return left and self.value(expression.right, signals)
        if expression.operator == "or":
            return left or self.value(expression.right, signals)
        right = self.value(expression.right, signals)
        whole = isinstance(expression.left.type, IntType | TimeType)
        match expression.operator:
            case "==" | "!=" | "<" | "<=" | ">" | ">=":
                return COMPARISONS[expression.operator](left, right)
            case "+":
                result = left + right
            case "-":
                result = left - right
            case "*":
                result = left * right
            case "/" | "%":
                if right == 0:
                    raise FaultError("division by zero")
                quotient = (
                    int(math.copysign(1, left) * math.copysign(1, right)) * (abs(left) // abs(right)) if whole else 0
                )
                if expression.operator == "/":
                    result = quotient if whole else left / right
                else:
                    result = left - quotient * right if whole else math.fmod(left, right)
            case "^":
                result = left**right
            case _:
                assert_never(expression.operator)
        return checked(expression.type, result)


COMPARISONS: dict[str, Any] = {
    "==": lambda a, b: a == b, "!=": lambda a, b: a != b, "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
}  # fmt: skip


def half_away(x: float) -> float:
    return math.copysign(math.floor(abs(x) + 0.5) if abs(x) < 2**51 else abs(x), x)


def _finite(x: float) -> float:
    if not math.isfinite(x):
        raise FaultError("infinite or no number")
    return x


def _power_of_e(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


FUNCTIONS: dict[str, Any] = {
    "abs": abs,
    "min": min,
    "max": max,
    "limit": lambda x, low, high: low if x < low else high if x > high else x,
    "sign": lambda x: type(x)((x > 0) - (x < 0)),
    "sqrt": math.sqrt,
    "exp": _power_of_e,
    "log": math.log,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "atan2": math.atan2,
    "finite": _finite,
    "asin": lambda x: math.asin(x) if -1 <= x <= 1 else math.nan,
    "acos": lambda x: math.acos(x) if -1 <= x <= 1 else math.nan,
    "atan": math.atan,
    "floor": lambda x: float(math.floor(x)),
    "ceil": lambda x: float(math.ceil(x)),
    "round": half_away,
    "quantize": lambda x, step: step * half_away(x / step),
    "deadzone": lambda x, width: x - width if x > width else x + width if x < -width else type(x)(0),
    "seconds": lambda t: t / 1e9,
}


def zero(kind: Type) -> Any:
    """The value zero or false of a type."""
    match kind:
        case BoolType():
            return False
        case RealType():
            return 0.0
        case ArrayType():
            return tuple(zero(kind.element) for _ in range(kind.size or 0))
        case StructType():
            return tuple(zero(field) for _, field in kind.fields)
        case IntType() | TimeType() | EnumType():
            return 0
        case _:
            raise AssertionError(kind)
