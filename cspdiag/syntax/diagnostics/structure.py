"""Diagnostics of the structure of a text."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.edits import replacing
from cspdiag.base.record import record


@record
class UnexpectedText(Diagnostic):
    code = "E0101"
    title = "unexpected text"

    found: str
    expected: str
    advice: str | None = None
    keyword: str | None = None
    """The keyword that was certainly meant."""

    @property
    def message(self) -> str:
        return f"expected {self.expected}, found {self.found}"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (replacing(self.span, self.keyword),) if self.keyword else ()


@record
class NestedTooDeeply(Diagnostic):
    code = "E0103"
    title = "nested too deeply"

    limit: int
    process: str | None = None
    """The first process that is nested too deeply in others."""

    @property
    def message(self) -> str:
        if self.process is None:
            return f"this is nested deeper than {self.limit} levels"
        return f"the process `{self.process}` has processes inside each other deeper than {self.limit} levels"

    @property
    def help(self) -> str | None:
        if self.process is None:
            return "give parts of it names: `let` or `const` for expressions, processes for compositions"
        return "let one process contain several others instead of nesting each in the next"


@record
class ParenthesesNeeded(Diagnostic):
    code = "E0104"
    title = "parentheses needed"

    operator: str
    other: str
    other_span: Span
    advice: str

    @property
    def message(self) -> str:
        return f"`{self.operator}` and `{self.other}` need parentheses to say which comes first"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other_span, f"`{self.other}` is here"),)


@record
class KeywordAsName(Diagnostic):
    code = "E0107"
    title = "keyword used as a name"

    word: str

    @property
    def message(self) -> str:
        return f"`{self.word}` is a keyword and cannot be a name"

    @property
    def help(self) -> str | None:
        if self.word == "_":
            return "only an arrow can discard values, as in `sensor.level -> _`; a process reads into a variable"
        return f"choose another name, for example `{self.word}_`"


@record
class WrongOperator(Diagnostic):
    code = "E0108"
    title = "wrong operator"

    found: str
    expected: str
    purpose: str
    replaced: Span | None = None
    """The text that can simply be replaced by ``expected``; None if more has to be changed."""

    @property
    def message(self) -> str:
        return f"{self.purpose} is written `{self.expected}`, not `{self.found}`"

    @property
    def help(self) -> str | None:
        return f"write `{self.expected}`"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (replacing(self.replaced, self.expected),) if self.replaced else ()


@record
class Unclosed(Diagnostic):
    code = "E0109"
    title = "unbalanced brackets"

    bracket: str
    opening: Span | None

    @property
    def message(self) -> str:
        if self.opening is None:
            return f"this `{self.bracket}` closes nothing"
        return f"`{self.bracket}` is missing after this"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.opening is None else (Label(self.opening, f"`{self.opening.text}` is opened here"),)

    @property
    def help(self) -> str | None:
        return f"remove the `{self.bracket}`" if self.opening is None else f"close it with `{self.bracket}`"


@record
class ArrowWithoutEnd(Diagnostic):
    code = "E0118"
    title = "arrow without an end"

    lacks: str

    @property
    def message(self) -> str:
        return f"this arrow has no {self.lacks}"

    @property
    def help(self) -> str | None:
        if self.lacks == "sink":
            return "end it at a port, at a label with a type, or at `_`, which discards the values"
        return "begin it at an `in` port of this process or at an `out` port of an instance"


@record
class WrongPlace(Diagnostic):
    code = "E0119"
    title = "not the place for this"

    what: str
    rule: str
    fix: Edit | None = None

    @property
    def message(self) -> str:
        return f"{self.what} is not allowed here"

    @property
    def help(self) -> str | None:
        return self.rule

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (self.fix,) if self.fix else ()
