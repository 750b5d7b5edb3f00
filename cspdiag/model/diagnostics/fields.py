"""A part of a struct where only the whole can stand."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class PartByItself(Diagnostic):
    """A field of a struct is set, read or written by itself.

    What a variable holds and what passes a channel changes as a whole, so that nobody ever sees a struct of which one field is new and
    another is old. The new struct is built from the old one.

    Refused::

        struct Pose {
          x: double
          y: double
        }

        process Main {
          out pose : Pose
          communication { var p : Pose = Pose(x = 0, y = 0) }
          composition { p.x := 3 ; pose ! p }
        }

    Mended::

        struct Pose {
          x: double
          y: double
        }

        process Main {
          out pose : Pose
          communication { var p : Pose = Pose(x = 0, y = 0) }
          composition { p := Pose(x = 3, y = p.y) ; pose ! p }
        }
    """

    code = "E0236"
    title = "a field of a struct by itself"

    name: str
    problem: str
    advice: str
    declared: Span | None
    whole: str

    @property
    def message(self) -> str:
        return f"`{self.name}` {self.problem}"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.whole}` is declared here"),) if self.declared else ()
