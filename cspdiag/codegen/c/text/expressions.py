"""Expressions of the network as C expressions: with few parentheses, checked integer operations, IEEE reals, and a
defined order of faults.
"""

from __future__ import annotations

from math import copysign, pi
from typing import assert_never

from cspdiag.codegen.c.text.code import (
    AND,
    EQUALITY,
    NOW,
    OR,
    PRODUCT,
    RELATION,
    SUM,
    Aggregate,
    Atom,
    Code,
    Element,
    call,
    cast,
    conditional,
    infix,
    member_of,
    minus,
    negated,
    target,
)
from cspdiag.codegen.c.text.evaluation import Evaluator
from cspdiag.codegen.c.text.operands import (
    decided_by_ranges,
    folded,
    is_int64,
    is_lvalue,
    is_undefined_in_c,
    known_result,
    widened,
)
from cspdiag.codegen.shared.operations import (
    COMPARISONS,
    integer_name,
    known_comparison,
    opposite,
    range_check,
    truth_of,
)
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    IntType,
    RealType,
    StructType,
    TimeType,
    Type,
    is_double,
    is_single,
)
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
    TunableValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.faults import (
    conversion_fits,
    divisor_may_be_zero,
    index_fits,
)
from cspdiag.network.ir.ranges import needs_check

_LOGIC = {"and": ("&&", AND), "or": ("||", OR)}
_ARITHMETIC = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "%": PRODUCT}
_CHECKED = {"+": "csp_add", "-": "csp_subtract", "*": "csp_multiply", "/": "csp_quotient", "%": "csp_remainder"}
_OF_TIMES = {
    name: name.replace("csp_", "csp_time_")
    for name in ("csp_add", "csp_subtract", "csp_multiply", "csp_quotient", "csp_negate", "csp_absolute")
}
"""The same operations, with faults that speak of times."""
_REAL_FUNCTIONS = {
    "abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil", "round": "round", "exp": "csp_exp",
    "log": "csp_log",
    "sin": "csp_sin", "cos": "csp_cos", "tan": "csp_tan", "asin": "csp_asin", "acos": "csp_acos", "atan": "csp_atan",
    "atan2": "csp_atan2", "min": "csp_min", "max": "csp_max",
    "limit": "csp_limit", "sign": "csp_sign", "quantize": "csp_quantize", "deadzone": "csp_deadzone",
    "finite": "csp_real",
}  # fmt: skip
_SINGLE_FUNCTIONS = {
    "abs": "fabsf", "sqrt": "sqrtf", "floor": "floorf", "ceil": "ceilf", "round": "roundf",
    **{name: f"csp_{name}_single" for name in ("min", "max", "limit", "sign", "deadzone")},
    "finite": "csp_real_single",
}  # fmt: skip
"""Those whose result in single precision is that in double precision, rounded."""
_WHOLE_FUNCTIONS = {
    "min": "csp_min_int", "max": "csp_max_int", "limit": "csp_limit_int", "sign": "csp_sign_int", "until": "csp_until",
    "abs": "csp_absolute_int",
}  # fmt: skip


class Printer(Evaluator):
    """Prints the expressions of one class."""

    def _print(self, expression: Expression) -> Code:
        """The C expression; its type is the C type for that of ``expression``."""
        match expression:
            case LiteralValue():
                return self._literal(expression)
            case ParameterValue(name=name):
                return self.parameter(name)
            case TunableValue():
                return target(self.reference(expression))
            case VariableValue(channel=channel):
                return self._variable(channel)
            case SignalValue(name=name):
                return self.signal(name)
            case PresentTime(type=TimeType()):
                return NOW
            case PresentTime():
                assert self.time is not None, "time is known in environments only"
                return Atom(self.time)
            case UnaryOperation(operator="not", operand=operand):
                return self._negated(operand)
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
            case FieldValue(operand=TunableValue() as operand, field=name):
                return member_of(self.reference(operand), self.types.field(name))
            case FieldValue(operand=operand, field=name):
                return self._print(operand).field(self.types.field(name))
            case ElementValue():
                return self._element(expression)
            case StructValue(values=values):
                assert isinstance(expression.type, StructType)
                fields = zip(expression.type.fields, self._in_order(values), strict=True)
                named = tuple((f".{self.types.field(name)}", part) for (name, _), part in fields)
                return Aggregate(named, self.types.type_name(expression.type))
            case ArrayElements(values=values):
                inner = Aggregate(tuple((None, part) for part in self._in_order(values)))
                return Aggregate(((None, inner),), self.types.type_name(expression.type))
        assert_never(expression)

    def reference(self, expression: TunableValue) -> Code:
        """A pointer to a parameter of the program."""
        return self.program(expression.name) if expression.of_program else self.parameter(expression.name)

    def _literal(self, expression: LiteralValue) -> Code:
        name = self._name_of(expression)
        if name is not None:
            return Atom(name)
        if expression.value == pi and expression.type == RealType(64):
            return Atom("CSP_PI")
        return self.types.literal(expression.value, expression.type, expression.span)

    def _name_of(self, literal: LiteralValue) -> str | None:
        """The C name of a constant, where a name is possible."""
        if literal.name is None or self.constants_by_value:
            return None
        return self.constants.get(literal.name) or self.types.names.constants.get(literal.name)

    def _negated(self, condition: Expression) -> Code:
        """The negation of a condition."""
        other = opposite(condition)
        return negated(self._print(condition)) if other is None else self._print(other)

    def _negation(self, expression: UnaryOperation) -> Code:
        code = self._print(expression.operand)
        if isinstance(expression.type, RealType):
            return minus(code)
        if is_int64(expression.type):
            return call(_checked("csp_negate", expression.type), code) if needs_check(expression) else minus(code)
        return self._narrow(expression, minus(widened(code, expression.operand.type)))

    def _operation(self, expression: BinaryOperation) -> Code:
        operator = expression.operator
        if operator in _LOGIC:
            symbol, precedence = _LOGIC[operator]
            return infix(
                symbol, precedence, self._print(expression.left), self._conditionally_evaluated(expression.right)
            )
        if operator in COMPARISONS:
            return self._comparison(expression)
        left, right = self._in_order((expression.left, expression.right))
        if isinstance(expression.left.type, RealType):
            return self._real_operation(expression, left, right)
        return self._whole_operation(expression, left, right)

    def _real_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        single = "_single" if is_single(expression.type) else ""
        match operator:
            case "^":
                code = call("csp_pow", left, right)
            case "%":
                code = call("fmod", left, right)
            case "/" if divisor_may_be_zero(expression):
                return call(f"csp_divide{single}", left, right)
            case "+" if _is_positive_zero(expression.right):
                return call(f"csp_positive_zero{single}", left)
            case "+" | "-" | "*" | "/" | "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
                return infix(operator, _ARITHMETIC[operator], left, right)
            case _:
                assert_never(operator)
        return cast("float", code) if is_single(expression.type) else code

    def _whole_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        if isinstance(expression.type, IntType) and (known := known_result(expression)) is not None:
            return self.types.literal(known, expression.type)
        if operator in ("+", "-") and self._is_zero(expression.right) and expression.left.type == expression.type:
            return left
        if operator == "^":
            return self._narrow(expression, call("csp_power", left, right))
        by_zero = operator in "/%" and divisor_may_be_zero(expression)
        if is_int64(expression.type) and (by_zero or needs_check(expression) or is_undefined_in_c(expression)):
            return call(_checked(_CHECKED[operator], expression.type), left, right)
        if by_zero:
            return self._narrow(expression, call(_CHECKED[operator], left, right))
        if is_int64(expression.type):
            narrow = self._is_int(expression.left) and self._is_int(expression.right)
            return infix(operator, _ARITHMETIC[operator], cast("int64_t", left) if narrow else left, right)
        # Next to an operand of 64 bits, a literal needs no conversion.
        if not self._is_int(expression.left) or self._is_int(expression.right):
            left = widened(left, expression.left.type)
        if not self._is_int(expression.right):
            right = widened(right, expression.right.type)
        return self._narrow(expression, infix(operator, _ARITHMETIC[operator], left, right))

    def _narrow(self, expression: Expression, code: Code) -> Code:
        """The result of an operation in a wider type, converted back, with a check if it may be out of range."""
        if is_int64(expression.type):
            return code
        checked = range_check(expression)
        if checked is not None:
            return call(f"csp_{checked}", code)
        return cast(self.types.type_name(expression.type), code)

    def _is_int(self, expression: Expression) -> bool:
        """Whether an operand is a literal of C type ``int``."""
        if isinstance(expression, Conversion) and isinstance(expression.type, IntType):
            return self._is_int(expression.operand) and conversion_fits(expression)
        if not isinstance(expression, LiteralValue) or not isinstance(expression.type, IntType):
            return False
        return self._name_of(expression) is None

    def _is_zero(self, expression: Expression) -> bool:
        """Whether an integer operand is the literal 0, which needs not be added."""
        value = expression.value if isinstance(expression, LiteralValue) and self._name_of(expression) is None else None
        return type(value) is int and value == 0

    def _comparison(self, expression: BinaryOperation) -> Code:
        known = self._known_comparison(expression)
        if known is not None:
            return known
        operator, left, right = expression.operator, expression.left, expression.right
        first, second = self._in_order((left, right))
        if isinstance(left.type, StructType | ArrayType):
            equal = call(f"{self.types.suffix(left.type)}_equal", first, second)
            return equal if operator == "==" else negated(equal)
        truth = truth_of(expression)
        if truth is not None:
            return first if truth[1] else negated(first)
        precedence = EQUALITY if operator in ("==", "!=") else RELATION
        return infix(operator, precedence, first, second)

    def _known_comparison(self, expression: BinaryOperation) -> Code | None:
        """The result of a comparison, if it is known: compilers rightly warn about code that compares anyway."""
        operator, left, right = expression.operator, expression.left, expression.right
        known = known_comparison(expression, by_name=True)
        if known is None and (self.faults(left) or self.faults(right)):
            return None
        known = decided_by_ranges(expression) if known is None else known
        if known is not None:
            return self._truth(known)
        number, other = self._as_texts(left, right)
        if number != other or isinstance(left.type, StructType | ArrayType):
            return None
        equal = operator in ("==", "<=", ">=")
        if isinstance(left.type, RealType) and (equal or operator == "!="):
            return negated(call("isnan", number)) if equal else call("isnan", number)
        return self._truth(equal)

    @staticmethod
    def _truth(value: bool) -> Code:
        return Atom("true" if value else "false")

    def _choice(self, expression: ConditionalValue) -> Code:
        condition = self._print(expression.condition)
        code = conditional(
            condition,
            self._conditionally_evaluated(expression.then),
            self._conditionally_evaluated(expression.otherwise),
        )
        if isinstance(expression.type, IntType) and not is_int64(expression.type):
            return cast(self.types.type_name(expression.type), code)
        return code

    def _function(self, expression: FunctionCall) -> Code:
        function, given = expression.function, expression.arguments
        if function == "seconds":
            if self.seconds is not None and isinstance(given[0], ParameterValue):
                return self.seconds(given[0].name, is_double(expression.type))
            seconds = call("csp_seconds", self._print(given[0]))
            return cast("float", seconds) if is_single(expression.type) else seconds
        codes = self._in_order(given)
        code: Code
        if isinstance(expression.type, RealType):
            is_own = is_single(expression.type) and function in _SINGLE_FUNCTIONS
            name = _SINGLE_FUNCTIONS[function] if is_own else _REAL_FUNCTIONS[function]
            code = folded(name, codes) if function in ("min", "max") else call(name, *codes)
            return cast("float", code) if is_single(expression.type) and not is_own else code
        if function == "abs" and needs_check(expression):
            return self._narrow(expression, call(_checked("csp_absolute", expression.type), codes[0]))
        name = _WHOLE_FUNCTIONS[function]
        code = folded(name, codes) if function in ("min", "max") else call(name, *codes)
        return code if is_int64(expression.type) else cast(self.types.type_name(expression.type), code)

    def _conversion(self, expression: Conversion) -> Code:
        type_, operand = expression.type, expression.operand
        code = self._print(operand)
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
        return code if self._is_int(expression) or self.types.type_name(operand.type) == name else cast(name, code)

    def _element(self, expression: ElementValue) -> Code:
        operand, index = self._in_order((expression.operand, expression.index))
        assert isinstance(expression.operand.type, ArrayType)
        if not is_lvalue(expression.operand):
            operand = self._save(operand, expression.operand.type)
        if not index_fits(expression):
            index = call("csp_index", index, str(expression.operand.type.size))
        if isinstance(expression.operand, TunableValue):
            return Element(member_of(self.reference(expression.operand), "at"), index.as_index())
        return Element(operand.field("at"), index.as_index())


def _checked(function: str, type_: Type) -> str:
    """The function for an operation of 64 bits whose result is checked."""
    return _OF_TIMES.get(function, function) if isinstance(type_, TimeType) else function


def _is_positive_zero(expression: Expression) -> bool:
    value = expression.value if isinstance(expression, LiteralValue) else None
    return isinstance(value, int | float) and value == 0 and copysign(1.0, value) > 0
