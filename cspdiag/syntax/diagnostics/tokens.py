"""What can be wrong with single tokens, and with declarations whose text is well formed."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record

_TIMES = {
    "sec": "s",
    "seconds": "s",
    "second": "s",
    "msec": "ms",
    "millis": "ms",
    "usec": "us",
    "nsec": "ns",
    "minute": "min",
    "minutes": "min",
    "hz": "Hz",
    "khz": "kHz",
    "KHz": "kHz",
    "mhz": "MHz",
}
"""Other spellings of the units of durations and frequencies."""

_LONG_TIMES = {"h": 60, "hour": 60, "hours": 60, "d": 1440, "day": 1440, "days": 1440}
"""Units of time that the language does not have, in minutes."""


@record
class UnknownCharacter(Diagnostic):
    """A character that begins nothing in the language.

    Programs are written in ASCII outside of comments and strings.

    Refused::

        process Main {
          composition { skip $ }
        }

    Mended::

        process Main {
          composition { skip }
        }
    """

    code = "E0102"
    title = "unknown character"

    character: str
    instead: str | None

    @property
    def message(self) -> str:
        if self.character.isidentifier():
            return f"`{self.character}` is no name: names are ASCII letters, digits and `_`"
        shown = self.character if self.character.isprintable() else f"U+{ord(self.character):04X}"
        return f"`{shown}` has no meaning in the language"

    @property
    def help(self) -> str | None:
        return f"write `{self.instead}`" if self.instead else None


@record
class UnterminatedString(Diagnostic):
    """A string has no closing quotes.

    A string ends on the line on which it begins, so that a forgotten quote does not swallow the rest of the file.

    Refused::

        driver Encoder python "encoder.py:Encoder {
          out angle : double<rad>
        }

    Mended::

        driver Encoder python "encoder.py:Encoder" {
          out angle : double<rad>
        }
    """

    code = "E0105"
    title = "unterminated string"

    @property
    def message(self) -> str:
        return "this string has no closing quotes on its line"

    @property
    def help(self) -> str | None:
        return 'end it with `"`'


@record
class UnterminatedComment(Diagnostic):
    """A comment that begins with ``/*`` has no ``*/``.

    Everything up to the end of the file would belong to it. Comments do not nest.

    Refused::

        process Main {
          composition { skip }
        }
        /* to be continued

    Mended::

        process Main {
          composition { skip }
        }
        /* to be continued */
    """

    code = "E0106"
    title = "unterminated comment"

    @property
    def message(self) -> str:
        return "this comment has no end"

    @property
    def help(self) -> str | None:
        return "end it with `*/`"


@record
class NumberOutOfRange(Diagnostic):
    """A number that no type can hold.

    A ``double`` ends near 1.8e308, an ``int`` and the nanoseconds of a ``time`` at 64 bits; 64 digits are enough for any of them.

    Refused::

        const Large = 1e999

    Mended::

        const Large = 1e300
    """

    code = "E0110"
    title = "number out of range"

    @property
    def message(self) -> str:
        return "this number is too large, or has too many digits"


@record
class ZeroFrequency(Diagnostic):
    """A frequency of zero.

    A frequency stands for its period wherever a ``time`` is wanted, and zero has none.

    Refused::

        const Rate = 0 Hz

    Mended::

        const Rate = 50 Hz
    """

    code = "E0111"
    title = "frequency of zero"

    @property
    def message(self) -> str:
        return "a frequency of zero has no period"


@record
class NotAnInstanceName(Diagnostic):
    """An instance is declared under something that is not a name.

    An instance has a name, ``servo : Servo``, or a name and one size for an array of instances, ``cell[8] : Cell``.

    Refused::

        process Idle {
          composition { skip }
        }

        process Main {
          communication { idle.one : Idle }
          composition { idle }
        }

    Mended::

        process Idle {
          composition { skip }
        }

        process Main {
          communication { idle : Idle }
          composition { idle }
        }
    """

    code = "E0112"
    title = "name of an instance"

    @property
    def message(self) -> str:
        return "an instance needs a plain name, or a name and one size for an array of instances"


@record
class SourceDiscarded(Diagnostic):
    """The discarding sink ``_`` begins an arrow.

    It takes values and gives none, so it can only end an arrow.

    Refused::

        process Main {
          out y : int
          communication { _ -> y }
          composition { skip }
        }

    Mended::

        process Main {
          out y : int
          composition { y ! 1 }
        }
    """

    code = "E0113"
    title = "discard as a source"

    @property
    def message(self) -> str:
        return "`_` discards values and gives none: it can only end an arrow"


@record
class LabelNotAName(Diagnostic):
    """The label of an arrow is not a plain name.

    The label names the communication object, which is no port: ports stand at the ends of an arrow.

    Refused::

        process Main {
          in  x : int
          out y : int
          communication { x -> some.label : int -> y }
          composition { skip }
        }

    Mended::

        process Main {
          out y : int
          composition { y ! 1 }
        }
    """

    code = "E0114"
    title = "label of an arrow"

    @property
    def message(self) -> str:
        return "the label in the middle of an arrow, or before a type at its end, is a plain name"


@record
class OptionNotHere(Diagnostic):
    """A clause in the head of a definition that means nothing there.

    ``wcet`` belongs to submodels and processes, ``step`` and ``method`` to submodels, ``step`` and ``on miss`` to environments,
    ``python "module.py:Class"`` to submodels, processes and drivers.

    Refused::

        process Main step 1 ms {
          composition { skip }
        }

    Mended::

        process Main {
          composition { skip }
        }
    """

    code = "E0115"
    title = "clause not allowed here"

    clause: str
    definition: str

    @property
    def message(self) -> str:
        return f"the head of a {self.definition} has no place for {self.clause}"

    @property
    def help(self) -> str | None:
        return "remove it"


@record
class OptionTwice(Diagnostic):
    """A clause stands twice in the head of a definition.

    One of the two would have to be forgotten, and the text does not say which.

    Refused::

        process Main wcet 1 ms wcet 2 ms {
          composition { skip }
        }

    Mended::

        process Main wcet 2 ms {
          composition { skip }
        }
    """

    code = "E0116"
    title = "clause said twice"

    clause: str
    definition: str

    @property
    def message(self) -> str:
        return f"the head of this {self.definition} has {self.clause} already"

    @property
    def help(self) -> str | None:
        return "keep one of them"


@record
class MissingUnitBrackets(Diagnostic):
    """A unit without its angle brackets, or with spaces in it.

    Durations and frequencies are a number and a unit: ``5 ms``, ``50 Hz``. Every other quantity has its unit in angle
    brackets directly after the number, without spaces: ``0.5<rad/s>``.

    Refused::

        const Speed = 0.5 rad

    Mended::

        const Speed = 0.5<rad>
    """

    code = "E0117"
    title = "unit without brackets"

    number: str
    unit: str

    @property
    def message(self) -> str:
        return f"`{self.unit}` after a number is no unit of time: other units stand in angle brackets, without spaces"

    @property
    def help(self) -> str | None:
        if self.unit in _TIMES:
            return f"write `{self.number} {_TIMES[self.unit]}`"
        if self.unit in _LONG_TIMES:
            return f"write `{float(self.number) * _LONG_TIMES[self.unit]:.15g} min`, the longest unit of time"
        product = f", or `{self.number} * {self.unit}` for a product" if self.unit.isidentifier() else ""
        return f"write `{self.number}<{self.unit.replace(' ', '')}>`{product}"
