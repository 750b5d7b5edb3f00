"""What can be wrong with types of values."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import IntType, RealType, Type
from cspdiag.model.wording import conversion, conversion_help, noun, shortened


@record
class WrongType(Diagnostic):
    code = "E0301"
    title = "a value of the wrong type"

    what: str
    found: Type
    wanted: str
    advice: str | None = None
    declared: Span | None = None
    declared_text: str = ""

    @property
    def message(self) -> str:
        return f"{self.what} is {self.wanted}, but this is {noun(self.found)}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, self.declared_text),) if self.declared else ()


@record
class MixedNumbers(Diagnostic):
    code = "E0304"
    title = "numbers of different types"

    operator: str
    left: Type
    right: Type
    left_span: Span
    right_span: Span

    @property
    def message(self) -> str:
        return f"`{self.operator}` cannot combine {noun(self.left)} and {noun(self.right)}"

    @property
    def help(self) -> str | None:
        if isinstance(self.left, RealType) and not isinstance(self.right, RealType):
            return conversion_help(self.right, RealType(self.left.bits), self.right_span.text)
        if isinstance(self.right, RealType) and not isinstance(self.left, RealType):
            return conversion_help(self.left, RealType(self.right.bits), self.left_span.text)
        if isinstance(self.left, IntType) and isinstance(self.right, IntType):
            if self.left.bits > self.right.bits:
                return conversion_help(self.right, self.left, self.right_span.text)
            return conversion_help(self.left, self.right, self.left_span.text)
        return conversion_help(self.right, self.left, self.right_span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return conversion(self.left, self.right, self.left_span) or conversion(self.right, self.left, self.right_span)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.left_span, f"this is {noun(self.left)}"),
            Label(self.right_span, f"this is {noun(self.right)}"),
        )


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
            return f"compare it: `{shortened(self.span)} != 0`"
        return None

    @property
    def edits(self) -> tuple[Edit, ...]:
        text, source = self.span.text, self.span.source.text
        if not isinstance(self.found, IntType) or not text.replace(".", "_").isidentifier():
            return ()
        is_negated = source[: self.span.start].rstrip().endswith("not")
        return (Edit(self.span, f"({text} != 0)" if is_negated else f"{text} != 0"),)


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
        if isinstance(self.first, IntType) and isinstance(self.second, RealType):
            return conversion_help(self.first, self.second, self.first_span.text)
        return conversion_help(self.second, self.first, self.span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        return conversion(self.first, self.second, self.first_span) or conversion(self.second, self.first, self.span)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, f"this is {noun(self.first)}"),)


@record
class UselessValue(Diagnostic):
    code = "E0315"
    title = "no value"

    what: str
    advice: str | None

    @property
    def message(self) -> str:
        return f"{self.what} cannot be used here"


@record
class ConstantNoTime(Diagnostic):
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
