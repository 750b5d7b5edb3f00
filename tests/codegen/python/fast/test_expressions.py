"""Expressions at ``-O1`` have the values and the faults that they have at ``-O0``, bit for bit."""

from __future__ import annotations

import math
import random
import struct
from collections.abc import Callable, Mapping
from typing import Any, Literal

import pytest

from cspdiag import runtime
from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import Code, Name
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.names import Names, PackageNames
from cspdiag.codegen.python.text.statements import assign, lines
from cspdiag.model.types import BOOL, DOUBLE, INT, ArrayType, IntType, RealType, TimeType, Type
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FunctionCall,
    LiteralValue,
    SignalValue,
    UnaryOperation,
)
from cspdiag.network.ir.walk import parts
from tests.codegen.packages import network

INT8, UINT8, TIME = IntType(bits=8), IntType(bits=8, signed=False), TimeType()
SINGLE = RealType(bits=32)
TABLE = ArrayType(element=DOUBLE, size=4)
SIGNALS: Mapping[str, Type] = {
    "speed": DOUBLE, "angle": DOUBLE, "count": INT, "gear": INT8, "level": UINT8, "patience": TIME, "held": BOOL,
    "coarse": SINGLE, "table": TABLE,
}  # fmt: skip
REALS = (
    0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 2.5, -2.5, 0.49999999999999994, 1e300, -1e300, 5e-324, math.inf, -math.inf,
    math.nan, 3.7,
)  # fmt: skip
WHOLE = (0, 1, -1, 2, 3, -3, 7, -7, 100, 127, -128, 255, 2**31, 2**63 - 1, -(2**63), 2**62)


class Drawn:
    """Random well-typed expressions."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def expression(self, type_: Type, depth: int) -> Expression:
        if depth == 0 or self.random.random() < 0.1:
            return self.leaf(type_)
        match type_:
            case RealType():
                return self.real(type_, depth - 1)
            case IntType() | TimeType():
                whole = self.whole(type_, depth - 1)
                if any(isinstance(part, SignalValue) for part in parts(whole)):
                    return whole
                return self.leaf(type_)  # the compiler refuses constants that overflow
        return self.truth(depth - 1)

    def leaf(self, type_: Type) -> Expression:
        names = [name for name, other in SIGNALS.items() if other == type_]
        if names and self.random.random() < 0.7:
            return SignalValue(type=type_, name=self.random.choice(names))
        match type_:
            case RealType():
                value: bool | int | float = self.random.choice([v for v in REALS if math.isfinite(v)])
                if type_.bits == 32:
                    value = struct.unpack("f", struct.pack("f", max(-1e30, min(value, 1e30))))[0]
            case IntType():
                value = self.random.choice([v for v in WHOLE if type_.minimum <= v <= type_.maximum])
            case TimeType():
                value = self.random.choice(WHOLE)
            case _:
                value = self.random.random() < 0.5
        return LiteralValue(type=type_, value=value)

    def conditional(self, type_: Type, depth: int) -> Expression:
        return ConditionalValue(
            type=type_,
            condition=self.expression(BOOL, depth),
            then=self.expression(type_, depth),
            otherwise=self.expression(type_, depth),
        )

    def call(self, name: Any, type_: Type, depth: int, count: int) -> Expression:
        given = tuple(self.expression(type_, depth) for _ in range(count))
        return FunctionCall(type=type_, function=name, arguments=given)

    def binary(self, operator: Any, type_: Type, operands: Type, depth: int) -> Expression:
        left, right = self.expression(operands, depth), self.expression(operands, depth)
        return BinaryOperation(type=type_, operator=operator, left=left, right=right)

    def real(self, type_: RealType, depth: int) -> Expression:
        match self.random.randrange(12):
            case 0 | 1 | 2 | 3:
                arithmetic: tuple[Literal["+", "-", "*", "/"], ...] = ("+", "-", "*", "/")
                return self.binary(self.random.choice(arithmetic), type_, type_, depth)
            case 4:
                return self.conditional(type_, depth)
            case 5:
                return self.call(self.random.choice(("limit",)), type_, depth, 3)
            case 6 | 7:
                return self.call(self.random.choice(("min", "max", "deadzone", "quantize", "atan2")), type_, depth, 2)
            case 8 | 9:
                names = ("abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "floor", "ceil", "round")
                return self.call(self.random.choice(names), type_, depth, 1)
            case 10:
                if type_.bits == 64:
                    array = SignalValue(type=TABLE, name="table")
                    index = self.expression(INT, depth)
                    if isinstance(index, LiteralValue):  # the compiler has checked these
                        index = SignalValue(type=INT, name="count")
                    return ElementValue(type=type_, operand=array, index=index)
                return UnaryOperation(type=type_, operator="-", operand=self.expression(type_, depth))
        source = self.random.choice((INT, DOUBLE, SINGLE))
        return Conversion(type=type_, operand=self.expression(source, depth))

    def whole(self, type_: Type, depth: int) -> Expression:
        match self.random.randrange(9):
            case 0 | 1 | 2:
                operators: tuple[Literal["+", "-", "*", "/", "%", "^"], ...] = ("+", "-", "*", "/", "%", "^")
                return self.binary(self.random.choice(operators), type_, type_, depth)
            case 3:
                return self.conditional(type_, depth)
            case 4:
                return self.call(self.random.choice(("min", "max")), type_, depth, 2)
            case 5:
                return self.call(self.random.choice(("abs", "sign")), type_, depth, 1)
            case 6:
                return self.call("limit", type_, depth, 3)
            case 7:
                return UnaryOperation(type=type_, operator="-", operand=self.expression(type_, depth))
        source = self.random.choice((INT, DOUBLE, INT8, UINT8, TIME))
        return Conversion(type=type_, operand=self.expression(source, depth))

    def truth(self, depth: int) -> Expression:
        match self.random.randrange(4):
            case 0:
                return UnaryOperation(type=BOOL, operator="not", operand=self.expression(BOOL, depth))
            case 1:
                return self.binary(self.random.choice(("and", "or", "==", "!=")), BOOL, BOOL, depth)
        operator: Any = self.random.choice(("<", "<=", ">", ">=", "==", "!="))
        operands = self.random.choice((DOUBLE, INT, UINT8))
        if self.random.random() < 0.3:
            magnitude = FunctionCall(type=operands, function="abs", arguments=(self.expression(operands, depth),))
            return BinaryOperation(type=BOOL, operator=operator, left=magnitude, right=self.expression(operands, depth))
        return self.binary(operator, BOOL, operands, depth)

    def inputs(self) -> dict[str, Any]:
        given: dict[str, Any] = {}
        for name, type_ in SIGNALS.items():
            match type_:
                case RealType(bits=32):
                    given[name] = runtime.float32(self.random.choice(REALS))
                case RealType():
                    given[name] = self.random.choice(REALS)
                case IntType():
                    given[name] = self.random.choice([v for v in WHOLE if type_.minimum <= v <= type_.maximum])
                case TimeType():
                    given[name] = self.random.choice(WHOLE)
                case ArrayType():
                    given[name] = tuple(self.random.choice(REALS) for _ in range(4))
                case _:
                    given[name] = self.random.random() < 0.5
        return given


def function(expression: Expression, printer: Printer) -> Callable[..., Any]:
    """A function of the signals that evaluates the expression as it is printed."""
    result = assign("result", printer.print(expression))
    text = [f"def evaluate({', '.join(SIGNALS)}):", *lines([result], "    "), "    return result"]
    imports = [line.replace("from .", "from cspdiag.") for line in printer.imports.lines()]
    scope: dict[str, Any] = {}
    exec("\n".join([*imports, *text]), scope)
    evaluate: Callable[..., Any] = scope["evaluate"]
    return evaluate


def outcome(evaluate: Callable[..., Any], inputs: dict[str, Any]) -> tuple[str, object]:
    """The type and the bits of a value, or the fault."""
    try:
        value = evaluate(**inputs)
    except (ArithmeticError, runtime.Fault, ValueError, IndexError) as error:
        return type(error).__name__, str(error)
    if isinstance(value, float):
        return "float", "nan" if value != value else struct.pack("d", value)
    return type(value).__name__, value


def printed(expression: Expression, names: PackageNames) -> str:
    """Both texts, shown if they differ."""
    plain = Printer(Imports(names, taken=SIGNALS), signal=signal)
    fast = FastPrinter(Imports(names, taken=SIGNALS), signal=signal, temporaries=Temporaries(Names(SIGNALS)))
    return f"\n{plain.print(expression).flat}\n{fast.print(expression).flat}"


def signal(name: str) -> Code:
    return Name(name)


@pytest.mark.parametrize("seed", range(8))
def test_values_and_faults_are_those_of_the_readable_code(seed: int) -> None:
    names = PackageNames(network("commstime"))
    drawn = Drawn(seed)
    for _ in range(150):
        type_ = drawn.random.choice((DOUBLE, DOUBLE, DOUBLE, INT, INT8, UINT8, TIME, BOOL, SINGLE))
        expression = drawn.expression(type_, 4)
        plain = function(expression, Printer(Imports(names, taken=SIGNALS), signal=signal))
        temporaries = Temporaries(Names(SIGNALS))
        fast = function(expression, FastPrinter(Imports(names, taken=SIGNALS), signal=signal, temporaries=temporaries))
        for _ in range(12):
            inputs = drawn.inputs()
            assert outcome(fast, inputs) == outcome(plain, inputs), expression


def test_constants_are_values() -> None:
    printer = FastPrinter(
        Imports(PackageNames(network("commstime"))), signal=signal, known={"stiction": 0.0156, "counts": 4096.0}
    )
    stiction = SignalValue(type=DOUBLE, name="stiction")
    assert printer.print(UnaryOperation(type=DOUBLE, operator="-", operand=stiction)).flat == "-0.0156"
    counts = SignalValue(type=DOUBLE, name="counts")
    turn = LiteralValue(type=DOUBLE, value=2.0)
    assert printer.print(BinaryOperation(type=DOUBLE, operator="/", left=turn, right=counts)).flat == "0.00048828125"
    torque = SignalValue(type=DOUBLE, name="torque")
    limited = FunctionCall(
        type=DOUBLE,
        function="limit",
        arguments=(
            BinaryOperation(type=DOUBLE, operator="*", left=torque, right=turn),
            UnaryOperation(type=DOUBLE, operator="-", operand=stiction),
            stiction,
        ),
    )
    shown = "-0.0156 if (x1 := torque * 2.0) < -0.0156 else 0.0156 if x1 > 0.0156 else x1"
    assert printer.print(limited).flat == shown
