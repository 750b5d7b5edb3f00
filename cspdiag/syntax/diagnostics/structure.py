"""What can be wrong with the structure of a text."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class UnexpectedText(Diagnostic):
    """Something stands where the language has no place for it.

    The message says what could have stood there. What follows is read again from the next declaration or definition on.

    Refused::

        process Main {
          out y : int
          composition { y ! }
        }

    Mended::

        process Main {
          out y : int
          composition { y ! 1 }
        }
    """

    code = "E0101"
    title = "unexpected text"

    found: str
    expected: str
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"expected {self.expected}, found {self.found}"

    @property
    def help(self) -> str | None:
        return self.advice


@record
class NestedTooDeeply(Diagnostic):
    """An expression or a composition is nested deeper than 200 levels.

    A level is an operator, a pair of parentheses within parentheses, an index, a call or a block inside another one. An operator chain of
    expressions such as ``a + b + c`` nests to the left, so it counts a level for each operator; chains of the composition
    (``;``, ``||`` and their kin) count one level whatever their length.

    Refused::

        process Main {
          out y : int
          composition {
            y !
            (((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((
            (((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((
            (((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((
            1
            )))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))
            )))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))
            )))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))
          }
        }

    Mended::

        process Main {
          out y : int
          composition { y ! 1 }
        }
    """

    code = "E0103"
    title = "nested too deeply"

    limit: int

    @property
    def message(self) -> str:
        return f"this is nested deeper than {self.limit} levels"

    @property
    def help(self) -> str | None:
        return "give parts of it names: `let` or `const` for expressions, processes for compositions"


@record
class ParenthesesNeeded(Diagnostic):
    """Two operators meet in a composition, and only parentheses say which one comes first.

    An operator chain uses one operator, as the composition diagram needs its parenthesis symbol where another one begins. In the
    same way ``mu``, ``catch`` and ``interrupt`` take a single operand: a process, a communication, or something in
    parentheses.

    Refused::

        process Main {
          out y : int
          out z : int
          composition { y ! 1 ; y ! 2 || z ! 3 }
        }

    Mended::

        process Main {
          out y : int
          out z : int
          composition { (y ! 1 ; y ! 2) || z ! 3 }
        }
    """

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

    @property
    def help(self) -> str | None:
        return self.advice


@record
class KeywordAsName(Diagnostic):
    """A keyword stands where a name is wanted.

    The words of the language are reserved, so that a text reads the same wherever it is cut.

    Refused::

        process Main {
          communication { var state : int = 0 }
          composition { state := 1 }
        }

    Mended::

        process Main {
          communication { var state_ : int = 0 }
          composition { state_ := 1 }
        }
    """

    code = "E0107"
    title = "keyword used as a name"

    word: str

    @property
    def message(self) -> str:
        return f"`{self.word}` is a word of the language and cannot be a name"

    @property
    def help(self) -> str | None:
        return f"choose another name, for example `{self.word}_`"


@record
class WrongOperator(Diagnostic):
    """An operator of another language, or of another place.

    ``=`` defines (constants, defaults, equations), ``:=`` assigns in a composition, ``==`` compares; logic is written
    ``and``, ``or`` and ``not``; an arrow is ``->``; a variable is counted up by ``n := n + 1``; a choice between values is
    ``if condition then a else b``. Numbers are decimal, and have digits on both sides of their point.

    Refused::

        process Main {
          communication { var count : int = 0 }
          composition { count = 1 }
        }

    Mended::

        process Main {
          communication { var count : int = 0 }
          composition { count := 1 }
        }
    """

    code = "E0108"
    title = "wrong operator"

    found: str
    wanted: str
    purpose: str

    @property
    def message(self) -> str:
        return f"{self.purpose} is written `{self.wanted}`, not `{self.found}`"

    @property
    def help(self) -> str | None:
        return f"write `{self.wanted}`"


@record
class Unclosed(Diagnostic):
    """A parenthesis, bracket or brace is opened and not closed, or closed and not opened.

    The label shows the opening one. The place of the error is where it could be missed for the first time.

    Refused::

        process Main {
          out y : int
          composition {
            y ! (1 + 2
          }
        }

    Mended::

        process Main {
          out y : int
          composition {
            y ! (1 + 2)
          }
        }
    """

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
    """An arrow of the communication diagram lacks its source or its sink.

    Every communication relationship leads from an output to an input. The sink ``_`` discards the values.

    Refused::

        submodel Source {
          out y : int
          y = 1
        }

        process Main {
          communication {
            source : Source
            source.y ->
          }
          composition { source }
        }

    Mended::

        submodel Source {
          out y : int
          y = 1
        }

        process Main {
          communication {
            source : Source
            source.y -> _
          }
          composition { source }
        }
    """

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
    """A part of the language at a place where it does not belong.

    A process has its ports first, then its communication diagram, then its composition diagram; a submodel its ports,
    then its equations. Declarations need nothing between them: ``;`` is the sequential operator and nothing else, and a
    comma stands between names of one type and period. ``until`` follows what its ``mu`` repeats.

    Refused::

        process Main {
          composition { y ! 1 }
          out y : int
        }

    Mended::

        process Main {
          out y : int
          composition { y ! 1 }
        }
    """

    code = "E0119"
    title = "not the place for this"

    what: str
    rule: str

    @property
    def message(self) -> str:
        return f"{self.what} cannot stand here"

    @property
    def help(self) -> str | None:
        return self.rule
