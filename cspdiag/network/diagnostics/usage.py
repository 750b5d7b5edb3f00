"""What is declared and never used."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class VariableUnused(Diagnostic):
    """A variable or a channel is declared and never used.

    It does no harm, but a reader of the diagram looks for its purpose in vain; often another name was meant where it should occur.

    Refused::

        process Main {
          out output : int
          communication {
            var count : int = 0
            var limit : int = 10
          }
          composition { mu (output ! count ; count := count + 1) until count == 10 }
        }

    Mended::

        process Main {
          out output : int
          communication {
            var count : int = 0
            var limit : int = 10
          }
          composition { mu (output ! count ; count := count + 1) until count == limit }
        }
    """

    code = "W0511"
    title = "variable, channel or label that nobody uses"
    severity = "warning"

    name: str

    @property
    def message(self) -> str:
        return f"nobody uses `{self.name}`"

    @property
    def help(self) -> str | None:
        return "leave it away"


@record
class PortUnused(Diagnostic):
    """A process declares a port and never uses it.

    Whoever is connected to an input that nobody reads may wait there for ever; an output that nobody writes never has a value. If
    an input is ignored on purpose, the communication block says so with `port -> _`.

    Refused::

        process Main {
          in  request : int
          out answer  : int
          composition { mu (answer ! 1 ; wait 1 ms) }
        }

    Mended::

        process Main {
          in  request : int
          out answer  : int
          communication { var last : int = 0 }
          composition { mu (request ? last ; answer ! last) }
        }
    """

    code = "W0512"
    title = "port that its process never uses"
    severity = "warning"

    port: str
    process: str
    direction: str

    @property
    def message(self) -> str:
        verb = "reads" if self.direction == "in" else "writes"
        return f"`{self.process}` never {verb} its port `{self.port}`"

    @property
    def help(self) -> str | None:
        if self.direction == "in":
            return f"use it, leave it away, or say that it is ignored with `{self.port} -> _`"
        return "write it with `!` or connect an instance to it, or leave it away"


@record
class InputDiscarded(Diagnostic):
    """A control law has an input that none of its equations uses.

    Each time it runs the law waits for a value of it and takes it, and then forgets it. That is hardly meant: an equation uses another name, or the input
    is left over.

    Refused::

        submodel Controller {
          in  setpoint : double
          in  angle    : double
          out voltage  : double
          voltage = 2 * setpoint
        }

        process Main {
          in  setpoint : double @ 1 ms
          in  angle    : double @ 1 ms
          out voltage  : double @ 1 ms
          communication {
            law : Controller
            setpoint    -> law.setpoint
            angle       -> law.angle
            law.voltage -> voltage
          }
          composition { mu law }
        }

    Mended::

        submodel Controller {
          in  setpoint : double
          in  angle    : double
          out voltage  : double
          voltage = 2 * (setpoint - angle)
        }

        process Main {
          in  setpoint : double @ 1 ms
          in  angle    : double @ 1 ms
          out voltage  : double @ 1 ms
          communication {
            law : Controller
            setpoint    -> law.setpoint
            angle       -> law.angle
            law.voltage -> voltage
          }
          composition { mu law }
        }
    """

    code = "W0514"
    title = "input that no equation uses"
    severity = "warning"

    port: str
    submodel: str

    @property
    def message(self) -> str:
        return f"no equation of `{self.submodel}` uses its input `{self.port}`: its values are taken and discarded"

    @property
    def help(self) -> str | None:
        return "use it in an equation, or leave the input away"


@record
class HandlerNeverRuns(Diagnostic):
    """A declared exception is caught that nothing inside raises, so that the handler never runs.

    An exception goes up from where it is raised: out of the process that raises it, and on from parallel to parallel and from process to process, until a
    `catch` names it. A `catch` sees what its own operand raises, and neither what runs beside it nor what comes after. Of `Timeout` and `Fault`, which nearly
    any step may end with, nothing is said; nor is it of processes that are written by hand.

    Refused::

        exception TooHot

        process Main {
          out heater : double
          communication { var now : double = 0 }
          composition {
            (if now > 250 then raise TooHot) ;
            (mu (heater ! 1 ; wait 1 s) catch TooHot -> heater ! 0)
          }
        }

    Mended::

        exception TooHot

        process Main {
          out heater : double
          communication { var now : double = 0 }
          composition {
            (
              (if now > 250 then raise TooHot) ;
              mu (heater ! 1 ; wait 1 s)
            )
            catch TooHot -> heater ! 0
          }
        }
    """

    code = "W0515"
    title = "handler of an exception that is never raised there"
    severity = "warning"

    exception: str
    is_caught_inside: bool
    declared: Span

    @property
    def message(self) -> str:
        if self.is_caught_inside:
            return f"this handler never runs: `{self.exception}` is caught further inside and does not come out"
        return f"this handler never runs: nothing that the `catch` watches raises `{self.exception}`"

    @property
    def help(self) -> str | None:
        if self.is_caught_inside:
            return "leave one of the two away, or raise the exception again in the inner handler"
        return "put the `catch` around what raises the exception, in parentheses where that is several steps, or leave it away"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.exception}` is declared here"),)
