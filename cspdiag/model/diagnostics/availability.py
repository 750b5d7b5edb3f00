"""Values that are not to be had where they are named."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class NotConstant(Diagnostic):
    """A value that changes while the program runs stands where it must be known before.

    Sizes, sample periods, arguments of definitions, defaults, safe values and initial values are fixed when the diagram is drawn out.
    They may use numbers, constants, parameters and replicators.

    Refused::

        process Main {
          out y : int
          communication {
            var x : int = 0
            var z : int = x
          }
          composition { y ! x + z }
        }

    Mended::

        const start = 0

        process Main {
          out y : int
          communication {
            var x : int = start
            var z : int = start
          }
          composition { y ! x + z }
        }
    """

    code = "E0209"
    title = "a value that must be known before the program runs"

    name: str
    kind: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, but this must be known before the program runs"

    @property
    def help(self) -> str:
        return "use numbers, constants and parameters here"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class NotAvailableHere(Diagnostic):
    """``time``, ``sample`` or an operator with memory is used where it has no meaning.

    ``sample`` and the operators with memory (``pre``, ``delay``, ``integral``, ``derivative``, ``lag``, ``transfer``, ``statespace``)
    belong to the equations of a submodel, which is computed once a sample. ``time`` is the present instant of an environment and of
    the submodels used there. A control law counts samples instead, so that it can be tested without a clock.

    Refused::

        const T = sample

    Mended::

        const T = 1 ms
    """

    code = "E0210"
    title = "not available here"

    what: str
    where: str
    declared: Span | None = None
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.what}` is not available in {self.where}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.what}` is used here"),) if self.declared else ()
