"""Expressions of the network as C expressions: least parentheses, checked integers, IEEE reals, a defined order of faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from math import pi
from operator import eq, ge, gt, le, lt, ne
from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.codegen.c.text.code import (
    AND,
    CONDITIONAL,
    EQUALITY,
    OR,
    PRODUCT,
    RELATION,
    SUM,
    UNARY,
    Code,
    call,
    cast,
    infix,
)
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import ArrayType, BoolType, IntType, RealType, StructType, TimeType, Type
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
    Value,
    VariableValue,
)
from cspdiag.network.ir.faults import conversion_fits, divisor_may_be_zero, index_fits, may_fault
from cspdiag.network.ir.ranges import needs_check, value_range

_LOGIC = {"and": ("&&", AND), "or": ("||", OR)}
_COMPARISONS = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
_ARITHMETIC = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "%": PRODUCT}
_CHECKED = {"+": "csp_add", "-": "csp_subtract", "*": "csp_multiply", "/": "csp_quotient", "%": "csp_remainder"}
_REAL_FUNCTIONS = {
    "abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil", "round": "round", "exp": "csp_exp", "log": "csp_log",
    "sin": "csp_sin", "cos": "csp_cos", "tan": "csp_tan", "asin": "csp_asin", "acos": "csp_acos", "atan": "csp_atan", "atan2": "csp_atan2", "min": "csp_min", "max": "csp_max",
    "limit": "csp_limit", "sign": "csp_sign", "quantize": "csp_quantize", "deadzone": "csp_deadzone",
    "finite": "csp_real",
}  # fmt: skip
_WHOLE_FUNCTIONS = {"min": "csp_min_int", "max": "csp_max_int", "limit": "csp_limit_int", "sign": "csp_sign_int"}


def _unexpected(name: str) -> str:
    raise LookupError(f"{name} cannot be used here")


@dataclass(frozen=True)
class Printer:
    """Prints the expressions of one class; the functions give the C lvalue of a name where the expression stands.

    C does not say which operand comes first, so operands that can fault are evaluated into ``temporaries`` where there is more than one;
    they are to be declared before the statement.
    """

    types: CTypes
    parameter: Callable[[str], str] = _unexpected
    signal: Callable[[str], str] = _unexpected
    variable: Callable[[str], str] = _unexpected
    seconds: Callable[[str], str] | None = None
    """A parameter of type ``time`` in seconds."""
    time: str | None = None
    constants_by_value: bool = False
    """For static initializers, which C wants to be made of literals."""
    temporaries: list[tuple[str, str]] = field(default_factory=list)
    _numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def take_temporaries(self) -> list[str]:
        """Declarations of the temporaries since the last call: ``int64_t csp_left;``."""
        taken = [f"{kind} {name};" for kind, name in self.temporaries]
        self.temporaries.clear()
        return taken

    def print(self, expression: Expression) -> Code:
        """The C expression; it has the C type of the type of ``expression``."""
        match expression:
            case LiteralValue():
                return self._literal(expression)
            case ParameterValue(name=name):
                return Code(self.parameter(name))
            case VariableValue(channel=channel):
                return Code(self.variable(channel))
            case SignalValue(name=name):
                return Code(self.signal(name))
            case PresentTime():
                assert self.time is not None, "time is known in environments only"
                return Code(self.time)
            case UnaryOperation(operator="not", operand=BinaryOperation(operator="==") as equal):
                return self.print(replaced(equal, operator="!="))
            case UnaryOperation(operator="not", operand=operand):
                return Code(f"!{self.print(operand).at_least(UNARY)}", UNARY)
            case UnaryOperation():
                return self._negation(expression)
            case BinaryOperation():
                return self._operation(expression)
            case ConditionalValue():
                return self._choice(expression)
            case FunctionCall():
                return self._function(expression)
            case Conversion():
                return self._conversion(expression)
            case FieldValue(operand=operand, field=name):
                return Code(f"{self.print(operand)}.{self.types.field(name)}")
            case ElementValue():
                return self._element(expression)
            case StructValue(values=values):
                assert isinstance(expression.type, StructType)
                setup, parts = self._in_order(values)
                named = zip(expression.type.fields, parts, strict=True)
                inner = ", ".join(
                    f".{self.types.field(name)} = {part.at_least(CONDITIONAL)}" for (name, _), part in named
                )
                return self._after(setup, Code(f"({self.types.type_name(expression.type)}){{{inner}}}"))
            case ArrayElements(values=values):
                setup, parts = self._in_order(values)
                inner = ", ".join(part.at_least(CONDITIONAL) for part in parts)
                return self._after(setup, Code(f"({self.types.type_name(expression.type)}){{{{{inner}}}}}"))
        assert_never(expression)

    def _literal(self, expression: LiteralValue) -> Code:
        name = expression.name
        if name is not None and name in self.types.names.constants and not self.constants_by_value:
            return Code(self.types.names.constants[name])
        if expression.value == pi and expression.type == RealType(64):
            return Code("CSP_PI")
        return self.types.literal(expression.value, expression.type, expression.span)

    def _in_order(self, expressions: Sequence[Expression]) -> tuple[list[str], list[Code]]:
        """The operands, and assignments before them that keep faults in order: of those that can fault only the last stays in place."""
        codes = [self.print(part) for part in expressions]
        faulty = [position for position, part in enumerate(expressions) if may_fault(part)]
        setup = []
        for position in faulty[:-1]:
            name = self._temporary(expressions[position].type)
            setup.append(f"{name} = {codes[position].at_least(CONDITIONAL)}")
            codes[position] = Code(name)
        return setup, codes

    def _temporary(self, type_: Type) -> str:
        name = f"csp_operand_{next(self._numbers)}"
        self.temporaries.append((self.types.type_name(type_), name))
        return name

    @staticmethod
    def _after(setup: list[str], code: Code) -> Code:
        return Code(f"({', '.join([*setup, code.at_least(CONDITIONAL)])})") if setup else code

    def _negation(self, expression: UnaryOperation) -> Code:
        code = self.print(expression.operand)
        if isinstance(expression.type, RealType):
            return Code(f"-{_negatable(code)}", UNARY)
        if _is_word(expression.type):
            return call("csp_negate", code) if needs_check(expression) else Code(f"-{_negatable(code)}", UNARY)
        wide = _wide(code, expression.operand.type)
        return self._narrow(expression, Code(f"-{_negatable(wide)}", UNARY))

    def _operation(self, expression: BinaryOperation) -> Code:
        operator = expression.operator
        if operator in _LOGIC:
            symbol, precedence = _LOGIC[operator]
            return infix(symbol, precedence, self.print(expression.left), self.print(expression.right))
        if operator in _COMPARISONS:
            return self._comparison(expression)
        setup, (left, right) = self._in_order((expression.left, expression.right))
        if isinstance(expression.left.type, RealType):
            return self._after(setup, self._real_operation(expression, left, right))
        return self._after(setup, self._whole_operation(expression, left, right))

    def _real_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        match operator:
            case "^":
                code = call("csp_pow", left, right)
            case "%":
                code = call("fmod", left, right)
            case "/" if divisor_may_be_zero(expression):
                code = call("csp_divide", left, right)
            case _:
                return infix(operator, _ARITHMETIC[operator], left, right)
        return cast("float", code) if expression.type == replaced(expression.type, bits=32) else code

    def _whole_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        if isinstance(expression.type, IntType) and (known := _known_result(expression)) is not None:
            return self.types.literal(known, expression.type)
        if operator == "^":
            return self._narrow(expression, call("csp_power", left, right))
        by_zero = operator in "/%" and divisor_may_be_zero(expression)
        if _is_word(expression.type) and (by_zero or needs_check(expression) or _traps(expression)):
            return call(_CHECKED[operator], left, right)
        if by_zero:
            return self._narrow(expression, call(_CHECKED[operator], left, right))
        literals = isinstance(expression.left, LiteralValue) and isinstance(expression.right, LiteralValue)
        if _is_word(expression.type):
            return infix(operator, _ARITHMETIC[operator], cast("int64_t", left) if literals else left, right)
        wide = _wide(left, expression.left.type), _wide(right, expression.right.type)
        return self._narrow(expression, infix(operator, _ARITHMETIC[operator], *wide))

    def _narrow(self, expression: Expression, code: Code) -> Code:
        """The result of an operation that was made in a wider type, checked where it may not fit."""
        if _is_word(expression.type):
            return code
        assert isinstance(expression.type, IntType)
        if needs_check(expression):
            return call(f"csp_{integer_name(expression.type)}", code)
        return cast(self.types.type_name(expression.type), code)

    def _comparison(self, expression: BinaryOperation) -> Code:
        known = self._known_comparison(expression)
        if known is not None:
            return known
        operator, left, right = expression.operator, expression.left, expression.right
        setup, (first, second) = self._in_order((left, right))
        if isinstance(left.type, StructType | ArrayType):
            equal = call(f"{self.types.suffix(left.type)}_equal", first, second)
            return self._after(setup, equal if operator == "==" else Code(f"!{equal}", UNARY))
        if isinstance(right, LiteralValue) and isinstance(right.type, BoolType):
            return first if bool(right.value) == (operator == "==") else Code(f"!{first.at_least(UNARY)}", UNARY)
        precedence = EQUALITY if operator in ("==", "!=") else RELATION
        return self._after(setup, infix(operator, precedence, first, second))

    def _known_comparison(self, expression: BinaryOperation) -> Code | None:
        """A comparison whose result is known; compilers rightly complain about code that makes it."""
        operator, left, right = expression.operator, expression.left, expression.right
        first, second = _literal_value(left), _literal_value(right)
        compare = _COMPARISONS[operator]
        if first is not None and second is not None:
            return self._truth(bool(compare(first, second)))
        if may_fault(left) or may_fault(right):
            return None
        if isinstance(left.type, IntType | TimeType):
            (low, high), (least, greatest) = value_range(left), value_range(right)
            results = {
                "<": (high < least, low >= greatest),
                "<=": (high <= least, low > greatest),
                ">": (low > greatest, high <= least),
                ">=": (low >= greatest, high < least),
                "==": (False, high < least or low > greatest),
                "!=": (high < least or low > greatest, False),
            }[operator]
            if any(results):
                return self._truth(results[0])
        number = self.print(left).text
        if number != self.print(right).text or isinstance(left.type, StructType | ArrayType):
            return None
        equal = operator in ("==", "<=", ">=")
        if isinstance(left.type, RealType) and (equal or operator == "!="):
            return Code(f"{'!' if equal else ''}isnan({number})", UNARY)
        return self._truth(equal)

    @staticmethod
    def _truth(value: bool) -> Code:
        return Code("true" if value else "false")

    def _choice(self, expression: ConditionalValue) -> Code:
        condition, then, otherwise = map(self.print, (expression.condition, expression.then, expression.otherwise))
        code = Code(f"{condition.at_least(OR)} ? {then.at_least(OR)} : {otherwise.at_least(CONDITIONAL)}", CONDITIONAL)
        if isinstance(expression.type, IntType) and not _is_word(expression.type):
            return cast(self.types.type_name(expression.type), code)
        return code

    def _function(self, expression: FunctionCall) -> Code:
        function, given = expression.function, expression.arguments
        if function == "seconds":
            if self.seconds is not None and isinstance(given[0], ParameterValue):
                return Code(self.seconds(given[0].name))
            seconds = call("csp_seconds", self.print(given[0]))
            return cast("float", seconds) if expression.type == replaced(expression.type, bits=32) else seconds
        setup, codes = self._in_order(given)
        if isinstance(expression.type, RealType):
            code = _folded(_REAL_FUNCTIONS[function], codes) if function in ("min", "max") else None
            code = code or call(_REAL_FUNCTIONS[function], *codes)
            return self._after(setup, cast("float", code) if expression.type.bits == 32 else code)
        if function == "abs":
            code = call("csp_absolute", codes[0])
            return self._after(setup, self._narrow(expression, code))
        name = _WHOLE_FUNCTIONS[function]
        code = _folded(name, codes) if function in ("min", "max") else call(name, *codes)
        if not _is_word(expression.type):
            code = cast(self.types.type_name(expression.type), code)
        return self._after(setup, code)

    def _conversion(self, expression: Conversion) -> Code:
        type_, operand = expression.type, expression.operand
        code = self.print(operand)
        name = self.types.type_name(type_)
        if isinstance(type_, RealType):
            if isinstance(operand.type, RealType) and operand.type.bits == type_.bits:
                return code
            if isinstance(operand.type, BoolType) or type_.bits == 64 or isinstance(operand.type, RealType):
                return cast(name, code)
            return cast(name, cast("double", code))
        if isinstance(operand.type, RealType):
            return call(f"csp_{integer_name(type_)}_of_real", code)
        if not conversion_fits(expression):
            return call(f"csp_{integer_name(type_)}", code)
        return code if self.types.type_name(operand.type) == name else cast(name, code)

    def _element(self, expression: ElementValue) -> Code:
        setup, (operand, index) = self._in_order((expression.operand, expression.index))
        assert isinstance(expression.operand.type, ArrayType)
        if not _is_lvalue(expression.operand):
            name = self._temporary(expression.operand.type)
            setup.append(f"{name} = {operand.at_least(CONDITIONAL)}")
            operand = Code(name)
        if index_fits(expression):
            return self._after(setup, Code(f"{operand}.at[{index}]"))
        return self._after(setup, Code(f"{operand}.at[csp_index({index}, {expression.operand.type.size})]"))


def integer_name(type_: Type) -> str:
    """``int64``, ``uint8``: what functions of the support code are called after."""
    return f"{'' if type_.signed else 'u'}int{type_.bits}" if isinstance(type_, IntType) else "int64"


def _is_word(type_: Type) -> bool:
    """Whether values of a type of whole numbers are ``int64_t``."""
    return isinstance(type_, TimeType) or (isinstance(type_, IntType) and type_.bits == 64)


def _wide(code: Code, type_: Type) -> Code:
    """An operand in a type in which no operation of two such operands overflows."""
    small = isinstance(type_, IntType) and (type_.bits == 8 or (type_.bits == 16 and type_.signed))
    return code if small else cast("int64_t", code)


def _negatable(code: Code) -> str:
    text = code.at_least(UNARY)
    return f"({text})" if text.startswith("-") else text


def _folded(function: str, codes: Sequence[Code]) -> Code:
    result = codes[0]
    for code in codes[1:]:
        result = call(function, result, code)
    return result


def _literal_value(expression: Expression) -> Value | None:
    match expression:
        case LiteralValue(value=bool(value) | int(value) | float(value)):
            return value
        case UnaryOperation(operator="-", operand=LiteralValue(value=int(value) | float(value))) if not may_fault(
            expression
        ):
            return -value
    return None


def _known_result(expression: Expression) -> int | None:
    """The value of an operation on literals, if it has one: compilers would see through it and complain of what surrounds it."""
    if isinstance(expression, LiteralValue) and expression.name is None and type(expression.value) is int:
        return expression.value
    if not isinstance(expression, BinaryOperation) or not isinstance(expression.type, IntType):
        return None
    left, right = _known_result(expression.left), _known_result(expression.right)
    if left is None or right is None:
        return None
    match expression.operator:
        case "+":
            value = left + right
        case "-":
            value = left - right
        case "*":
            value = left * right
        case "/" | "%" if right != 0:
            quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
            value = quotient if expression.operator == "/" else left - quotient * right
        case _:
            return None
    return value if expression.type.minimum <= value <= expression.type.maximum else None


def _traps(expression: BinaryOperation) -> bool:
    """Whether an operation that has a value may be one that C leaves undefined: the remainder of the least whole number and -1."""
    low, high = value_range(expression.right)
    return expression.operator == "%" and low <= -1 <= high and value_range(expression.left)[0] == IntType().minimum


def _is_lvalue(expression: Expression) -> bool:
    """Whether the C expression is an object, so that its elements are as well."""
    match expression:
        case FieldValue(operand=operand):
            return _is_lvalue(operand)
        case ElementValue(operand=operand):
            return _is_lvalue(operand) and not may_fault(expression)
        case StructValue() | ArrayElements():
            return not may_fault(expression)
    return isinstance(expression, LiteralValue | ParameterValue | VariableValue | SignalValue)
