"""What the parser says about text that is no program."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic
from cspdiag.diagnostics.record import record


@record
class UnexpectedText(Diagnostic):
    """Something stands where it cannot."""

    code = "E0101"
    title = "unexpected text"

    found: str
    expected: str

    @property
    def message(self) -> str:
        return f"expected {self.expected} here, not {self.found}"


@record
class NestedTooDeeply(Diagnostic):
    """Nested too deeply."""

    code = "E0103"
    title = "nested too deeply"

    @property
    def message(self) -> str:
        return "nested deeper than 200 levels"


@record
class NumberOutOfRange(Diagnostic):
    """A number too large."""

    code = "E0110"
    title = "number out of range"

    @property
    def message(self) -> str:
        return "the number is out of range"


@record
class ZeroFrequency(Diagnostic):
    """A frequency of zero has no period."""

    code = "E0111"
    title = "frequency of zero"

    @property
    def message(self) -> str:
        return "a frequency of zero has no period"


@record
class NotAnInstanceName(Diagnostic):
    """The name of an instance is a name."""

    code = "E0112"
    title = "name of an instance"

    @property
    def message(self) -> str:
        return "an instance needs a plain name, or a name and one size for an array of instances"


@record
class SourceDiscarded(Diagnostic):
    """``_`` is only a sink."""

    code = "E0113"
    title = "discard as a source"

    @property
    def message(self) -> str:
        return "`_` takes values and gives none: it can only end an arrow"


@record
class LabelNotAName(Diagnostic):
    """A label is a plain name."""

    code = "E0114"
    title = "label of an arrow"

    @property
    def message(self) -> str:
        return "the label of an arrow is a plain name"


@record
class OptionNotHere(Diagnostic):
    """A clause that means nothing here."""

    code = "E0115"
    title = "clause not allowed here"

    clause: str
    definition: str

    @property
    def message(self) -> str:
        return f"a {self.definition} has no `{self.clause}`"


@record
class OptionTwice(Diagnostic):
    """A clause said twice."""

    code = "E0116"
    title = "clause said twice"

    clause: str
    definition: str

    @property
    def message(self) -> str:
        return f"the {self.definition} has `{self.clause}` already"
