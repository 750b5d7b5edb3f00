"""Types of calls of the functions of the language (language, section 6)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.model.diagnostics.arguments import UnknownOption, WrongNumberOfArguments
from cspdiag.model.diagnostics.availability import NotAvailableHere
from cspdiag.model.diagnostics.types import UnsuitableOperand
from cspdiag.model.diagnostics.units import NotConvertible, NotDimensionless, PowerWithoutUnit, UnknownUnit
from cspdiag.model.expressions.coercion import Purpose, default_number, require
from cspdiag.model.expressions.operators import unified
from cspdiag.model.types import (
    DOUBLE,
    INT,
    UNKNOWN,
    ArrayType,
    BoolType,
    IntType,
    RealType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import (
    DIMENSIONLESS,
    SECOND,
    Unit,
    agree,
    divide,
    multiply,
    near_unit,
    parse_unit,
    power,
    same_dimension,
)
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.expressions.expression_typer import ExpressionTyper


@record
class Signature:
    """How a function is written, and the least and the greatest number of its arguments (None: any)."""

    written: str
    least: int
    most: int | None
    has_memory: bool = False
    takes_method: bool = False


FUNCTIONS = {
    "abs": Signature("abs(x)", 1, 1),
    "min": Signature("min(a, b)", 2, None),
    "max": Signature("max(a, b)", 2, None),
    "limit": Signature("limit(x, lowest, highest)", 3, 3),
    "sign": Signature("sign(x)", 1, 1),
    "sqrt": Signature("sqrt(x)", 1, 1),
    "exp": Signature("exp(x)", 1, 1),
    "log": Signature("log(x)", 1, 1),
    "sin": Signature("sin(x)", 1, 1),
    "cos": Signature("cos(x)", 1, 1),
    "tan": Signature("tan(x)", 1, 1),
    "asin": Signature("asin(x)", 1, 1),
    "acos": Signature("acos(x)", 1, 1),
    "atan": Signature("atan(x)", 1, 1),
    "atan2": Signature("atan2(y, x)", 2, 2),
    "floor": Signature("floor(x)", 1, 1),
    "ceil": Signature("ceil(x)", 1, 1),
    "round": Signature("round(x)", 1, 1),
    "quantize": Signature("quantize(x, step)", 2, 2),
    "deadzone": Signature("deadzone(x, width)", 2, 2),
    "convert": Signature("convert(x, unit)", 2, 2),
    "pre": Signature("pre(x, initial)", 2, 2, has_memory=True),
    "delay": Signature("delay(x, samples, initial)", 3, 3, has_memory=True),
    "integral": Signature("integral(x, initial)", 2, 2, has_memory=True, takes_method=True),
    "derivative": Signature("derivative(x)", 1, 1, has_memory=True, takes_method=True),
    "lag": Signature("lag(x, tau)", 2, 2, has_memory=True, takes_method=True),
    "transfer": Signature("transfer([numerator], [denominator], x)", 3, 3, has_memory=True, takes_method=True),
    "statespace": Signature("statespace(A, B, C, D, x)", 5, 5, has_memory=True, takes_method=True),
}
METHODS = ("tustin", "zoh", "euler", "backward")


def function(typer: ExpressionTyper, node: ast.Call) -> Type:
    """The type of a call of a function of the language."""
    name = node.function.text
    signature = FUNCTIONS[name]
    context = typer.context
    arguments = _positional(typer, node, signature)
    if signature.has_memory and (typer.surroundings.place != "submodel" or typer.surroundings.constant):
        where = "a constant" if typer.surroundings.constant else f"the composition of a {typer.surroundings.place}"
        advice = "operators with memory belong to the equations of a submodel"
        context.refuse(NotAvailableHere(node.function.span, what=name, where=where, advice=advice), node)
        arguments = None
    if arguments is None:
        for argument in node.arguments:
            if argument.name is None and name != "convert":
                typer.infer(argument.value)
        return UNKNOWN
    match name:
        case "convert":
            return _convert(typer, node, arguments[0], arguments[1])
        case "transfer":
            return _transfer(typer, node, arguments)
        case "statespace":
            return _state_space(typer, node, arguments)
        case "delay":
            typer.constant(arguments[1], INT, Purpose(what="the number of samples of a delay"))
            return _remembered(typer, node, arguments[0], arguments[2])
        case "pre":
            return _remembered(typer, node, arguments[0], arguments[1])
        case "integral":
            return _integral(typer, node, arguments[0], arguments[1])
        case "lag":
            typer.constant(arguments[1], RealType(unit=SECOND), Purpose(what="the time constant of a lag"))
            return _real(typer, node, arguments[0])
        case "derivative":
            found = _real(typer, node, arguments[0])
            return RealType(found.bits, divide(found.unit, SECOND)) if isinstance(found, RealType) else found
        case "min" | "max" | "limit":
            return _comparable(typer, node, arguments)
        case "quantize" | "deadzone":
            return _reals(typer, node, arguments)
        case "abs":
            return _number(typer, node, arguments[0], takes_time=True)
        case "sign":
            found = _number(typer, node, arguments[0])
            return RealType(found.bits) if isinstance(found, RealType) else found
        case "floor" | "ceil" | "round":
            return _real(typer, node, arguments[0])
        case "sqrt":
            return _square_root(typer, node, arguments[0])
        case "atan2":
            return _angle(typer, node, arguments)
        case "exp" | "log" | "sin" | "cos" | "tan" | "asin" | "acos" | "atan":
            return _transcendental(typer, node, arguments[0])
        case _:
            raise AssertionError(f"`{name}` has a signature but no type")


def _positional(typer: ExpressionTyper, node: ast.Call, signature: Signature) -> list[ast.Expression] | None:
    """The arguments without the option ``method``; None if their number is wrong."""
    name = node.function.text
    given: list[ast.Expression] = []
    for argument in node.arguments:
        if argument.name is None:
            given.append(argument.value)
        elif argument.name.text != "method" or not signature.takes_method:
            options = ("method",) if signature.takes_method else ()
            owner = f"an option of `{name}`"
            if options:
                refused = UnknownOption(
                    argument.name.span,
                    owner=owner,
                    option=argument.name.text,
                    options=options,
                    suggestion=typer.context.speller.nearest(argument.name.text, options),
                )
                typer.context.refuse(refused, node)
            else:
                written = WrongNumberOfArguments(
                    node.span, function=name, given=len(node.arguments), signature=signature.written
                )
                typer.context.refuse(written, node)
            return None
        elif not isinstance(argument.value, ast.Name) or argument.value.name not in METHODS:
            option = argument.value.span.text
            refused = UnknownOption(
                argument.value.span,
                owner="a method of discretization",
                option=option,
                options=METHODS,
                suggestion=typer.context.speller.nearest(option, METHODS),
            )
            typer.context.refuse(refused, node)
            return None
    if not signature.least <= len(given) or (signature.most is not None and len(given) > signature.most):
        refused_number = WrongNumberOfArguments(node.span, function=name, given=len(given), signature=signature.written)
        typer.context.refuse(refused_number, node)
        return None
    return given


def _number(typer: ExpressionTyper, node: ast.Call, argument: ast.Expression, *, takes_time: bool = False) -> Type:
    found = typer.infer(argument)
    if isinstance(found, UnknownType | IntType | RealType) or (takes_time and isinstance(found, TimeType)):
        return found
    refused = UnsuitableOperand(argument.span, operator=node.function.text, found=found, advice=None)
    typer.context.refuse(refused, node)
    return UNKNOWN


def _real(typer: ExpressionTyper, node: ast.Call, argument: ast.Expression) -> Type:
    found = default_number(typer.context, argument, typer.infer(argument))
    if isinstance(found, UnknownType | RealType):
        return found
    advice = f"write `double({argument.span.text})`" if isinstance(found, IntType) else None
    refused = UnsuitableOperand(argument.span, operator=node.function.text, found=found, advice=advice)
    typer.context.refuse(refused, node)
    return UNKNOWN


def _transcendental(typer: ExpressionTyper, node: ast.Call, argument: ast.Expression) -> Type:
    found = _real(typer, node, argument)
    if not isinstance(found, RealType):
        return UNKNOWN
    if not agree(found.unit, DIMENSIONLESS):
        what = f"the argument of `{node.function.text}`"
        typer.context.refuse(NotDimensionless(argument.span, what=what, found=found), node)
        return UNKNOWN
    return RealType(found.bits)


def _square_root(typer: ExpressionTyper, node: ast.Call, argument: ast.Expression) -> Type:
    found = _real(typer, node, argument)
    if not isinstance(found, RealType):
        return UNKNOWN
    unit = DIMENSIONLESS if agree(found.unit, DIMENSIONLESS) else power(found.unit, 1, 2)
    if unit is None:
        typer.context.refuse(PowerWithoutUnit(node.span, found=found, operation="the square root"), node)
        return UNKNOWN
    return RealType(found.bits, unit)


def _angle(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    found = _reals(typer, node, arguments)
    return RealType(found.bits) if isinstance(found, RealType) else UNKNOWN


def _reals(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    for argument in arguments:
        if isinstance(_real(typer, node, argument), UnknownType):
            return UNKNOWN
    return _unified(typer, node, arguments)


def _comparable(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    for argument in arguments:
        _number(typer, node, argument, takes_time=True)
    return _unified(typer, node, arguments)


def _unified(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    types = [typer.context.program.types[argument] for argument in arguments]
    return unified(typer.context, arguments, types, f"the arguments of `{node.function.text}`", node)


def _convert(typer: ExpressionTyper, node: ast.Call, value: ast.Expression, target: ast.Expression) -> Type:
    found = _real(typer, node, value)
    text = "".join(target.span.text.split())
    unit = parse_unit(text)
    if unit is None:
        typer.context.refuse(UnknownUnit(target.span, text=text, suggestion=near_unit(text)), node)
        return UNKNOWN
    typer.context.program.types[target] = RealType(unit=unit)
    if not isinstance(found, RealType):
        return UNKNOWN
    if not same_dimension(found.unit, unit):
        typer.context.refuse(NotConvertible(node.span, found=found, target=f"`{text}`"), node)
        return UNKNOWN
    return RealType(found.bits, unit)


def _remembered(typer: ExpressionTyper, node: ast.Call, value: ast.Expression, initial: ast.Expression) -> Type:
    """The type of ``pre`` and ``delay``, which is that of their argument and of the initial value."""
    found = typer.infer(value)
    start = typer.before_running().infer(initial)
    if isinstance(found, UnknownType):
        is_number = isinstance(initial, ast.Number) and initial.unit is None
        return UNKNOWN if typer.context.guessing and is_number else start
    parts, types = [value, initial], [found, start]
    if value in typer.context.literals:
        return unified(typer.context, parts, types, f"the arguments of `{node.function.text}`", node)
    what = f"the initial value of `{node.function.text}`"
    require(typer.context, initial, start, found, Purpose(what=what))
    return found


def _integral(typer: ExpressionTyper, node: ast.Call, value: ast.Expression, initial: ast.Expression) -> Type:
    found = _real(typer, node, value)
    if not isinstance(found, RealType):
        start = typer.before_running().infer(initial)
        return start if isinstance(start, RealType) and start.unit != DIMENSIONLESS else UNKNOWN
    result = RealType(found.bits, multiply(found.unit, SECOND))
    typer.constant(initial, result, Purpose(what="the initial value of `integral`"))
    return result


def _transfer(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    """The type of ``transfer``. Coefficients of ``s^i`` are bare numbers, or have a unit times that of ``s^i``."""
    gains = [_polynomial(typer, argument) for argument in arguments[:2]]
    found = _real(typer, node, arguments[2])
    if not isinstance(found, RealType):
        return UNKNOWN
    numerator, denominator = gains
    return RealType(found.bits, divide(multiply(found.unit, numerator), denominator))


def _polynomial(typer: ExpressionTyper, coefficients: ast.Expression) -> Unit:
    if not isinstance(coefficients, ast.ArrayValue):
        found = typer.constant(coefficients, None, Purpose(what="a list of coefficients"))
        if not (isinstance(found, ArrayType) and isinstance(found.element, RealType)) and found != UNKNOWN:
            advice = "write the coefficients from the highest power of s down: `[1, 2.5, 1]`"
            refused = UnsuitableOperand(coefficients.span, operator="transfer", found=found, advice=advice)
            typer.context.refuse(refused, coefficients)
        return DIMENSIONLESS
    gain: Unit | None = None
    for position, coefficient in enumerate(coefficients.elements):
        found = typer.constant(coefficient, None, Purpose(what="a coefficient"))
        found = default_number(typer.context, coefficient, found)
        if not isinstance(found, RealType):
            if not isinstance(found, UnknownType):
                refused = UnsuitableOperand(coefficient.span, operator="transfer", found=found, advice=None)
                typer.context.refuse(refused, coefficients)
            continue
        if found.unit == DIMENSIONLESS:
            continue
        exponent = len(coefficients.elements) - 1 - position
        unit = divide(found.unit, power(SECOND, exponent) or DIMENSIONLESS)
        if gain is None:
            gain = unit
        elif not agree(gain, unit):
            expected = RealType(found.bits, multiply(gain, power(SECOND, exponent) or DIMENSIONLESS))
            what = f"the coefficient of `s^{exponent}`"
            require(typer.context, coefficient, found, expected, Purpose(what=what))
    typer.context.program.types[coefficients] = ArrayType(DOUBLE, len(coefficients.elements))
    return gain or DIMENSIONLESS


def _state_space(typer: ExpressionTyper, node: ast.Call, arguments: list[ast.Expression]) -> Type:
    """The type of ``statespace``: with the unit of the input, and an array if C has several rows."""
    rows: int | None = None
    shapes = []
    for letter, argument in zip("ABCD", arguments[:4], strict=True):
        size = len(argument.elements) if isinstance(argument, ast.ArrayValue) else None
        found = typer.constant(argument, None, Purpose(what=f"the matrix {letter}"))
        if isinstance(found, ArrayType) and found.size is not None:
            size = found.size
        expected = ArrayType(ArrayType(DOUBLE, None), size)
        require(typer.context, argument, found, expected, Purpose(what=f"the matrix {letter}"))
        shapes.append(size)
        if letter == "C":
            rows = size
    found = default_number(typer.context, arguments[4], typer.infer(arguments[4]))
    element = found.element if isinstance(found, ArrayType) else found
    if not isinstance(element, RealType):
        if not isinstance(element, UnknownType):
            refused = UnsuitableOperand(arguments[4].span, operator="statespace", found=found, advice=None)
            typer.context.refuse(refused, node)
        return UNKNOWN
    return element if rows == 1 else ArrayType(element, rows)


def conversion(typer: ExpressionTyper, node: ast.Call) -> Type:
    """The type of conversions such as ``int16(x)`` and ``double(x)``; a time becomes a number of seconds."""
    name = node.function.text
    target: Type = DOUBLE if name == "double" else RealType(32) if name == "float" else integer_named(name)
    if len(node.arguments) != 1 or node.arguments[0].name is not None:
        for argument in node.arguments:
            typer.infer(argument.value)
        given = len(node.arguments)
        refused = WrongNumberOfArguments(node.span, function=name, given=given, signature=f"{name}(x)")
        typer.context.refuse(refused, node)
        return target
    value = node.arguments[0].value
    found = typer.infer(value)
    match target, found:
        case _, UnknownType():
            return target
        case RealType(), RealType():
            return RealType(target.bits, found.unit)
        case RealType(), TimeType():
            return RealType(target.bits, SECOND)
        case ((RealType() | IntType()), (IntType() | BoolType())):
            return target
        case IntType(), RealType() if agree(found.unit, DIMENSIONLESS):
            return target
        case IntType(), RealType():
            typer.context.refuse(NotDimensionless(value.span, what=f"the argument of `{name}`", found=found), node)
        case _:  # Other pairs of types cannot be converted.
            typer.context.refuse(NotConvertible(node.span, found=found, target=f"`{name}`"), node)
    return target


def integer_named(name: str) -> IntType:
    """The integer type with a name (``int``, ``uint8``)."""
    signed = not name.startswith("u")
    return IntType(int(name.removeprefix("u").removeprefix("int") or 64), signed)
