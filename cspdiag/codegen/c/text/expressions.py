"""Expressions of the network as C expressions: least parentheses, checked integers, IEEE reals, a defined order of
faults.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from math import pi
from operator import eq, ge, gt, le, lt, ne
from typing import assert_never

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.text.code import (
    AND,
    EQUALITY,
    OR,
    PRODUCT,
    RELATION,
    SUM,
    Aggregate,
    Atom,
    Code,
    Element,
    assign,
    call,
    cast,
    conditional,
    in_order,
    infix,
    minus,
    negated,
)
from cspdiag.codegen.c.text.operands import (
    folded,
    integer_name,
    is_lvalue,
    is_word,
    known_result,
    literal_value,
    traps,
    widened,
)
from cspdiag.codegen.c.text.statements import Statement, define, run
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
    VariableValue,
)
from cspdiag.network.ir.faults import (
    conversion_fits,
    divisor_may_be_zero,
    index_fits,
    may_fault,
    variables_in,
)
from cspdiag.network.ir.ranges import needs_check, value_range

_LOGIC = {"and": ("&&", AND), "or": ("||", OR)}
_COMPARISONS = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
_ARITHMETIC = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "%": PRODUCT}
_OPPOSITES = {"==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<"}
_CHECKED = {"+": "csp_add", "-": "csp_subtract", "*": "csp_multiply", "/": "csp_quotient", "%": "csp_remainder"}
_REAL_FUNCTIONS = {
    "abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil", "round": "round", "exp": "csp_exp",
    "log": "csp_log",
    "sin": "csp_sin", "cos": "csp_cos", "tan": "csp_tan", "asin": "csp_asin", "acos": "csp_acos", "atan": "csp_atan",
    "atan2": "csp_atan2", "min": "csp_min", "max": "csp_max",
    "limit": "csp_limit", "sign": "csp_sign", "quantize": "csp_quantize", "deadzone": "csp_deadzone",
    "finite": "csp_real",
}  # fmt: skip
_WHOLE_FUNCTIONS = {
    "min": "csp_min_int", "max": "csp_max_int", "limit": "csp_limit_int", "sign": "csp_sign_int", "until": "csp_until",
}  # fmt: skip


def _unexpected(name: str) -> Code:
    raise LookupError(f"{name} cannot be used here")


def _sure(_: str) -> None:
    return None


@record
class Evaluation:
    """An expression in C: what has to be done before the statement in which it stands, and whether it can note a fault
    itself.
    """

    setup: tuple[Statement, ...]
    code: Code
    late: bool

    @property
    def faults(self) -> bool:
        """Whether a fault may have been noted when it has been evaluated."""
        return self.late or bool(self.setup)


@dataclass
class _Progress:
    """What was printed since the last evaluation began."""

    setup: list[Statement] = field(default_factory=list)
    inside: list[Code] | None = None
    """What has to be done first where no statement can stand, because it is evaluated only sometimes."""
    unsure: bool = False
    """Whether it is looked inside an expression whether a variable was written."""
    numbers: Iterator[int] = field(default_factory=lambda: count(1))


@dataclass(frozen=True)
class Printer:
    """Prints the expressions of one class; the functions give the C lvalue of a name where the expression stands.

    C does not say which operand comes first, so operands that can fault are evaluated before the statement, in their
    order, where there is more than one. ``written`` gives a pointer to the flag whether a variable was written, where
    that is not sure.
    """

    types: CTypes
    parameter: Callable[[str], Code] = _unexpected
    signal: Callable[[str], Code] = _unexpected
    variable: Callable[[str], Code] = _unexpected
    written: Callable[[str], Code | None] = _sure
    seconds: Callable[[str], Code] | None = None
    """A parameter of type ``time`` in seconds."""
    time: str | None = None
    constants_by_value: bool = False
    """For static initializers, which C wants to be made of literals."""
    progress: _Progress = field(default_factory=_Progress)

    def evaluate(self, expression: Expression) -> Evaluation:
        """The expression at the place of a statement."""
        return self._evaluated(expression, self._print)

    def opposite(self, condition: Expression) -> Evaluation:
        """The opposite of a condition."""
        return self._evaluated(condition, self._negated)

    def _evaluated(self, expression: Expression, made: Callable[[Expression], Code]) -> Evaluation:
        progress = self.progress
        progress.setup.clear()
        progress.unsure = False
        code = made(expression)
        return Evaluation(tuple(progress.setup), code, progress.unsure or may_fault(expression))

    def plain(self, expression: Expression) -> Code:
        """An expression before which nothing has to be done."""
        evaluation = self.evaluate(expression)
        assert not evaluation.setup, "it stands where no statement can be put in front"
        return evaluation.code

    def arguments(self, expressions: Sequence[Expression]) -> tuple[list[Statement], list[Code]]:
        """Several expressions in one statement, and what has to be done before it."""
        self.progress.setup.clear()
        codes = self._in_order(expressions)
        return list(self.progress.setup), codes

    def faults(self, expression: Expression) -> bool:
        """Whether the evaluation of an expression can note a fault."""
        if may_fault(expression):
            return True
        return any(self.written(channel) is not None for channel in variables_in(expression))

    def _print(self, expression: Expression) -> Code:
        """The C expression; it has the C type of the type of ``expression``."""
        match expression:
            case LiteralValue():
                return self._literal(expression)
            case ParameterValue(name=name):
                return self.parameter(name)
            case VariableValue(channel=channel):
                return self._variable(channel)
            case SignalValue(name=name):
                return self.signal(name)
            case PresentTime(type=TimeType()):
                return Atom("csp.now")
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

    def _literal(self, expression: LiteralValue) -> Code:
        name = expression.name
        if name is not None and name in self.types.names.constants and not self.constants_by_value:
            return Atom(self.types.names.constants[name])
        if expression.value == pi and expression.type == RealType(64):
            return Atom("CSP_PI")
        return self.types.literal(expression.value, expression.type, expression.span)

    def _variable(self, channel: str) -> Code:
        flag = self.written(channel)
        if flag is not None:
            required, progress = call("csp_require_written", flag), self.progress
            if progress.inside is not None:
                progress.unsure = True
                progress.inside.append(required)
            elif run(required) not in progress.setup:
                progress.setup.append(run(required))
        return self.variable(channel)

    def _in_order(self, expressions: Sequence[Expression]) -> list[Code]:
        """The operands, so that faults come in order: of those that can fault only the last stays in place."""
        faulting = [position for position, part in enumerate(expressions) if self.faults(part)]
        return [
            self._kept(part) if position in faulting[:-1] else self._print(part)
            for position, part in enumerate(expressions)
        ]

    def _kept(self, expression: Expression) -> Code:
        """The value of an operand, known before the operands behind it are evaluated."""
        code = self._print(expression)
        return code if isinstance(expression, VariableValue) else self._stored(code, expression.type)

    def _stored(self, code: Code, type_: Type) -> Code:
        progress = self.progress
        name, kind = f"csp_operand_{next(progress.numbers)}", self.types.type_name(type_)
        if progress.inside is None:
            progress.setup.append(define(f"const {kind}", name, code))
        else:
            progress.setup.append(define(kind, name))
            progress.inside.append(assign(name, code))
        return Atom(name)

    def _sometimes(self, expression: Expression) -> Code:
        """An operand that is not always evaluated: what has to be done first is a part of it."""
        progress = self.progress
        outer = progress.inside
        before: list[Code] = []
        progress.inside = before
        code = self._print(expression)
        progress.inside = outer
        return in_order((*before, code))

    def _negated(self, condition: Expression) -> Code:
        """The opposite; that of an order is another order, but for reals, of which a NaN is in none."""
        if isinstance(condition, BinaryOperation) and condition.operator in _OPPOSITES:
            whole = isinstance(condition.left.type, IntType | TimeType)
            if whole or condition.operator in ("==", "!="):
                return self._comparison(replaced(condition, operator=_OPPOSITES[condition.operator]))
        if isinstance(condition, UnaryOperation) and condition.operator == "not":
            return self._print(condition.operand)
        return negated(self._print(condition))

    def _negation(self, expression: UnaryOperation) -> Code:
        code = self._print(expression.operand)
        if isinstance(expression.type, RealType):
            return minus(code)
        if is_word(expression.type):
            return call("csp_negate", code) if needs_check(expression) else minus(code)
        return self._narrow(expression, minus(widened(code, expression.operand.type)))

    def _operation(self, expression: BinaryOperation) -> Code:
        operator = expression.operator
        if operator in _LOGIC:
            symbol, precedence = _LOGIC[operator]
            return infix(symbol, precedence, self._print(expression.left), self._sometimes(expression.right))
        if operator in _COMPARISONS:
            return self._comparison(expression)
        left, right = self._in_order((expression.left, expression.right))
        if isinstance(expression.left.type, RealType):
            return self._real_operation(expression, left, right)
        return self._whole_operation(expression, left, right)

    def _real_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        match operator:
            case "^":
                code = call("csp_pow", left, right)
            case "%":
                code = call("fmod", left, right)
            case "/" if divisor_may_be_zero(expression):
                code = call("csp_divide", left, right)
            case "+" | "-" | "*" | "/" | "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
                return infix(operator, _ARITHMETIC[operator], left, right)
            case _:
                assert_never(operator)
        return cast("float", code) if expression.type == replaced(expression.type, bits=32) else code

    def _whole_operation(self, expression: BinaryOperation, left: Code, right: Code) -> Code:
        operator = expression.operator
        if isinstance(expression.type, IntType) and (known := known_result(expression)) is not None:
            return self.types.literal(known, expression.type)
        if operator == "^":
            return self._narrow(expression, call("csp_power", left, right))
        by_zero = operator in "/%" and divisor_may_be_zero(expression)
        if is_word(expression.type) and (by_zero or needs_check(expression) or traps(expression)):
            return call(_CHECKED[operator], left, right)
        if by_zero:
            return self._narrow(expression, call(_CHECKED[operator], left, right))
        if is_word(expression.type):
            narrow = self._is_int(expression.left) and self._is_int(expression.right)
            return infix(operator, _ARITHMETIC[operator], cast("int64_t", left) if narrow else left, right)
        wide = widened(left, expression.left.type), widened(right, expression.right.type)
        return self._narrow(expression, infix(operator, _ARITHMETIC[operator], *wide))

    def _narrow(self, expression: Expression, code: Code) -> Code:
        """The result of an operation that was made in a wider type, checked where it may not fit."""
        if is_word(expression.type):
            return code
        assert isinstance(expression.type, IntType)
        if needs_check(expression):
            return call(f"csp_{integer_name(expression.type)}", code)
        return cast(self.types.type_name(expression.type), code)

    def _is_int(self, expression: Expression) -> bool:
        """Whether an operand is a literal that C takes for an ``int``."""
        if not isinstance(expression, LiteralValue) or not isinstance(expression.type, IntType):
            return False
        named = expression.name is not None and expression.name in self.types.names.constants
        return not named or self.constants_by_value

    def _comparison(self, expression: BinaryOperation) -> Code:
        known = self._known_comparison(expression)
        if known is not None:
            return known
        operator, left, right = expression.operator, expression.left, expression.right
        first, second = self._in_order((left, right))
        if isinstance(left.type, StructType | ArrayType):
            equal = call(f"{self.types.suffix(left.type)}_equal", first, second)
            return equal if operator == "==" else negated(equal)
        if isinstance(right, LiteralValue) and isinstance(right.type, BoolType):
            return first if bool(right.value) == (operator == "==") else negated(first)
        precedence = EQUALITY if operator in ("==", "!=") else RELATION
        return infix(operator, precedence, first, second)

    def _known_comparison(self, expression: BinaryOperation) -> Code | None:
        """A comparison whose result is known; compilers rightly complain about code that makes it."""
        operator, left, right = expression.operator, expression.left, expression.right
        first, second = literal_value(left), literal_value(right)
        compare = _COMPARISONS[operator]
        if first is not None and second is not None:
            return self._truth(bool(compare(first, second)))
        if self.faults(left) or self.faults(right):
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
        number = self._print(left)
        if number != self._print(right) or isinstance(left.type, StructType | ArrayType):
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
        code = conditional(condition, self._sometimes(expression.then), self._sometimes(expression.otherwise))
        if isinstance(expression.type, IntType) and not is_word(expression.type):
            return cast(self.types.type_name(expression.type), code)
        return code

    def _function(self, expression: FunctionCall) -> Code:
        function, given = expression.function, expression.arguments
        if function == "seconds":
            if self.seconds is not None and isinstance(given[0], ParameterValue):
                return self.seconds(given[0].name)
            seconds = call("csp_seconds", self._print(given[0]))
            return cast("float", seconds) if expression.type == replaced(expression.type, bits=32) else seconds
        codes = self._in_order(given)
        code: Code
        if isinstance(expression.type, RealType):
            name = _REAL_FUNCTIONS[function]
            code = folded(name, codes) if function in ("min", "max") else call(name, *codes)
            return cast("float", code) if expression.type.bits == 32 else code
        if function == "abs":
            return self._narrow(expression, call("csp_absolute", codes[0]))
        name = _WHOLE_FUNCTIONS[function]
        code = folded(name, codes) if function in ("min", "max") else call(name, *codes)
        return code if is_word(expression.type) else cast(self.types.type_name(expression.type), code)

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
        return code if self.types.type_name(operand.type) == name else cast(name, code)

    def _element(self, expression: ElementValue) -> Code:
        operand, index = self._in_order((expression.operand, expression.index))
        assert isinstance(expression.operand.type, ArrayType)
        if not is_lvalue(expression.operand):
            operand = self._stored(operand, expression.operand.type)
        if not index_fits(expression):
            index = call("csp_index", index, str(expression.operand.type.size))
        return Element(operand.field("at"), index)
