"""What the processor cannot do in time."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Label, Severity, Span
from cspdiag.base.record import record


@record
class Overload(Diagnostic):
    """The control laws need more time than there is.

    A law that runs every period ``T`` and takes up to ``wcet`` uses the part ``wcet``/``T`` of the processor. Those of parallel
    branches add up; of modes that follow one another the most demanding counts. A sum above one cannot be scheduled by any
    order of priorities (Liu and Layland, 1973), so that samples will be missed. Only laws that say their ``wcet`` and have a
    sample period are counted.

    Refused::

        submodel Law wcet 700 us {
          in  feedback : double
          out control  : double
          control = -feedback
        }

        process Main {
          in  left, right : double @ 1 ms
          out one, other  : double @ 1 ms
          communication {
            horizontal : Law
            vertical   : Law
            left  -> horizontal.feedback
            right -> vertical.feedback
            horizontal.control -> one
            vertical.control   -> other
          }
          composition { mu horizontal || mu vertical }
        }

    Mended::

        submodel Law wcet 700 us {
          in  feedback : double
          out control  : double
          control = -feedback
        }

        process Main {
          in  left, right : double @ 2 ms
          out one, other  : double @ 2 ms
          communication {
            horizontal : Law
            vertical   : Law
            left  -> horizontal.feedback
            right -> vertical.feedback
            horizontal.control -> one
            vertical.control   -> other
          }
          composition { mu horizontal || mu vertical }
        }
    """

    code: ClassVar[str] = "W0710"
    title: ClassVar[str] = "more work than time"
    severity: ClassVar[Severity] = "warning"

    process: str
    percent: int
    laws: tuple[tuple[str, int, Span], ...]
    """Path, share in per cent and place of the laws, the most demanding first."""

    @property
    def message(self) -> str:
        return f"the control laws of `{self.process}` need {self.percent} % of the processor"

    @property
    def help(self) -> str | None:
        return "let some of them run at longer periods, or make them faster and state the new `wcet`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, f"`{path}` needs {share} %") for path, share, place in self.laws[:4])
