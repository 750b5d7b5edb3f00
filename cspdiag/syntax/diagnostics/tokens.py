"""Diagnostics of single tokens, and of declarations that are well formed but not allowed."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit
from cspdiag.base.edits import removing, replacing
from cspdiag.base.record import record
from cspdiag.base.spelling import near_symbol

_TIMES = {
    "sec": "s",
    "secs": "s",
    "seconds": "s",
    "second": "s",
    "msec": "ms",
    "millis": "ms",
    "usec": "us",
    "mus": "us",
    "nsec": "ns",
    "minute": "min",
    "minutes": "min",
    "hz": "Hz",
    "khz": "kHz",
    "KHz": "kHz",
    "mhz": "MHz",
}
"""Other spellings of the units of durations and frequencies."""

_LONG_TIMES = {"h": 60, "hr": 60, "hrs": 60, "hour": 60, "hours": 60, "d": 1440, "day": 1440, "days": 1440}
"""Units of time that the language does not have, in minutes."""

_SYMBOLS = ("Hz", "kHz", "MHz", "ms", "us", "ns", "min")
"""The units of durations and frequencies, the more common ones first."""


@record
class UnknownCharacter(Diagnostic):
    code = "E0102"
    title = "unknown character"

    character: str
    instead: str | None

    @property
    def message(self) -> str:
        if self.character.isidentifier():
            return f"`{self.character}` is not a name: names are ASCII letters, digits and `_`"
        shown = self.character if self.character.isprintable() else f"U+{ord(self.character):04X}"
        return f"`{shown}` has no meaning in the language"

    @property
    def help(self) -> str | None:
        return f"write `{self.instead}`" if self.instead else None

    @property
    def edits(self) -> tuple[Edit, ...]:
        if self.instead == "us":
            # The rest of the unit follows the letter.
            return (Edit(self.span, "u"),) if self.span.source.text.startswith("s", self.span.end) else ()
        # A name in other letters would have to be changed everywhere.
        if self.instead is None or (self.character.isidentifier() and self.instead != "pi"):
            return ()
        return (replacing(self.span, self.instead.replace(" ", "")),)


@record
class UnterminatedString(Diagnostic):
    code = "E0105"
    title = "unterminated string"
    message = "this string has no closing quotes on its line"
    help = 'end it with `"`'


@record
class UnterminatedComment(Diagnostic):
    code = "E0106"
    title = "unterminated comment"
    message = "this comment has no end"
    help = "end it with `*/`"


@record
class NumberOutOfRange(Diagnostic):
    code = "E0110"
    title = "number out of range"
    message = "this number is too large, or has too many digits"


@record
class ZeroFrequency(Diagnostic):
    code = "E0111"
    title = "frequency of zero"
    message = "a frequency of zero has no period"


@record
class NotAnInstanceName(Diagnostic):
    code = "E0112"
    title = "name of an instance"
    message = "an instance needs a plain name, or a name and one size for an array of instances"


@record
class SourceDiscarded(Diagnostic):
    code = "E0113"
    title = "discard as a source"
    message = "`_` discards values and gives none: it can only end an arrow"


@record
class LabelNotAName(Diagnostic):
    code = "E0114"
    title = "label of an arrow"
    message = "the label in the middle of an arrow, or before a type at its end, is a plain name"


@record
class MisplacedClause(Diagnostic):
    code = "E0115"
    title = "clause not allowed here"
    help = "remove it"

    clause: str
    definition: str

    @property
    def message(self) -> str:
        return f"the head of a {self.definition} cannot have {self.clause}"


@record
class RepeatedClause(Diagnostic):
    code = "E0116"
    title = "clause given twice"
    help = "keep one of them"

    clause: str
    definition: str
    is_same: bool
    """Whether it is equal to the first one."""

    @property
    def message(self) -> str:
        return f"the head of this {self.definition} already has {self.clause}"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (removing(self.span),) if self.is_same else ()


@record
class MissingUnitBrackets(Diagnostic):
    code = "E0117"
    title = "unit without brackets"

    number: str
    unit: str

    @property
    def message(self) -> str:
        rule = "" if self._near else ": write other units in angle brackets, without spaces"
        return f"`{self.unit}` after a number is not a unit of time{rule}"

    @property
    def help(self) -> str | None:
        if self._near:
            return f"did you mean `{self._near}`?"
        explained = ", the longest unit of time" if self.unit in _LONG_TIMES else ""
        product = f", or `{self.number} * {self.unit}` for a product" if self.unit.isidentifier() else ""
        return f"write `{self._meant}`{explained or ('' if self.unit in _TIMES else product)}"

    @property
    def _near(self) -> str | None:
        if self.unit in _TIMES or self.unit in _LONG_TIMES:
            return None
        return near_symbol(self.unit, _SYMBOLS)

    @property
    def _meant(self) -> str:
        if self.unit in _TIMES:
            return f"{self.number} {_TIMES[self.unit]}"
        if self.unit in _LONG_TIMES:
            return f"{float(self.number) * _LONG_TIMES[self.unit]:.15g} min"
        return f"{self.number}<{self.unit.replace(' ', '')}>"

    @property
    def edits(self) -> tuple[Edit, ...]:
        is_sure = self.unit in _TIMES or self.unit in _LONG_TIMES or self.span.text.endswith(">")
        return (Edit(self.span, self._meant),) if is_sure else ()
