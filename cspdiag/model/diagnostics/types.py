"""Diagnostics of types of values."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import IntType, RealType, Type
from cspdiag.model.wording import conversion, conversion_help, noun, shortened, to_convert


@record
class UnexpectedType(Diagnostic):
    """A value of another type than what it is for."""

    what: str
    found: Type
    expected: Type
    declared: Span | None = None
    declared_text: str = ""

    @property
    def message(self) -> str:
        return f"{self.what} is {noun(self.expected)}, but this is {noun(self.found)}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, self.declared_text),) if self.declared else ()


@record
class WrongType(UnexpectedType):
    code = "E0301"
    title = "a value of the wrong type"

    @property
    def help(self) -> str | None:
        return conversion_help(self.found, self.expected, self.span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return conversion(self.found, self.expected, self.span)


@record
class MixedOperands(Diagnostic):
    """Two operands that an operator cannot combine."""

    operator: str
    left: Type
    right: Type
    left_span: Span
    right_span: Span

    @property
    def message(self) -> str:
        return f"`{self.operator}` cannot combine {noun(self.left)} and {noun(self.right)}"

    @property
    def to_convert(self) -> tuple[Type, Type, Span]:
        """See ``wording.to_convert``."""
        return to_convert(self.left, self.left_span, self.right, self.right_span)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.left_span, f"this is {noun(self.left)}"),
            Label(self.right_span, f"this is {noun(self.right)}"),
        )


@record
class MixedNumbers(MixedOperands):
    code = "E0304"
    title = "numbers of different types"

    @property
    def help(self) -> str | None:
        found, expected, span = self.to_convert
        if isinstance(expected, RealType) and isinstance(found, IntType):
            # A factor keeps its own unit.
            expected = RealType(expected.bits)
        return conversion_help(found, expected, span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return conversion(*self.to_convert)


@record
class UnsuitableOperand(Diagnostic):
    code = "E0306"
    title = "an operand of the wrong type"

    operator: str
    found: Type
    advice: str | None

    @property
    def message(self) -> str:
        return f"`{self.operator}` does not work on {noun(self.found)}"


@record
class NotCondition(Diagnostic):
    code = "E0308"
    title = "a condition that is not a bool"

    found: Type

    @property
    def message(self) -> str:
        return f"a condition is a bool, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        if isinstance(self.found, IntType | RealType):
            return f"compare it: `{self._compared(shortened(self.span))}`"
        return None

    @property
    def edits(self) -> tuple[Edit, ...]:
        text = self.span.text
        if not isinstance(self.found, IntType) or not text.replace(".", "_").isidentifier():
            return ()
        return (Edit(self.span, self._compared(text)),)

    def _compared(self, text: str) -> str:
        is_negated = self.span.source.text[: self.span.start].rstrip().endswith("not")
        return f"({text} != 0)" if is_negated else f"{text} != 0"


@record
class NotIndexed(Diagnostic):
    code = "E0311"
    title = "a wrong index"

    what: str
    problem: str
    advice: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"{self.what} {self.problem}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"{self.what} is declared here"),) if self.declared else ()


@record
class DifferentTypes(Diagnostic):
    code = "E0312"
    title = "values of different types"

    what: str
    first: Type
    second: Type
    first_span: Span

    @property
    def message(self) -> str:
        return f"{self.what} must have one type, but there is {noun(self.first)} and {noun(self.second)}"

    @property
    def help(self) -> str | None:
        found, expected, span = self._converted
        return conversion_help(found, expected, span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return conversion(*self._converted)

    @property
    def _converted(self) -> tuple[Type, Type, Span]:
        return to_convert(self.first, self.first_span, self.second, self.span)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, f"this is {noun(self.first)}"),)


@record
class UnusableValue(Diagnostic):
    code = "E0315"
    title = "not a value"

    what: str
    advice: str | None

    @property
    def message(self) -> str:
        return f"{self.what} cannot be used here"


@record
class ConstantNotTime(Diagnostic):
    code = "E0317"
    title = "a constant that is not a time"

    name: str
    found: Type
    what: str
    use: Span
    advice: str

    @property
    def message(self) -> str:
        return f"the constant `{self.name}` is {noun(self.found)}, but {self.what} is a time"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.use, "used as a time here"),)
