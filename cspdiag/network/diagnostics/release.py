"""What a process leaves behind on its outputs."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Label, Severity, Span
from cspdiag.base.record import record


@record
class OutputNotReleased(Diagnostic):
    """A loop of a control law ends, and its last value stays on a sampled output.

    A sampled output keeps its value until somebody writes another one. When a loop around a submodel has ended, the actuator
    goes on doing what the law asked for last, with nobody in control. In the published code of JIWY the joint was
    left pressing against its end stop in this way. Whoever ends a mode says what the actuator is to do then.

    Refused::

        submodel Speed {
          in  feedback : double<rad>
          out control  : double<V>
          out stop     : bool

          control = -1<V>
          stop    = feedback < -1<rad>
        }

        process Align {
          in  feedback : double<rad> @ 2 ms
          out control  : double<V>   @ 2 ms

          communication {
            speed : Speed

            feedback      -> speed.feedback
            speed.control -> control
            speed.stop    -> stop : bool
          }

          composition { mu speed until stop }
        }

    Mended::

        submodel Speed {
          in  feedback : double<rad>
          out control  : double<V>
          out stop     : bool

          control = -1<V>
          stop    = feedback < -1<rad>
        }

        process Align {
          in  feedback : double<rad> @ 2 ms
          out control  : double<V>   @ 2 ms

          communication {
            speed : Speed

            feedback      -> speed.feedback
            speed.control -> control
            speed.stop    -> stop : bool
          }

          composition { (mu speed until stop) ; control ! 0<V> }
        }
    """

    code = "W0690"
    title = "output not released"
    severity: ClassVar[Severity] = "warning"

    process: str
    port: str
    instance: str
    release: str
    """A value that lets go of the actuator, as it is written."""
    port_span: Span

    @property
    def message(self) -> str:
        return f"`{self.process}` ends with the last value of `{self.instance}` on its output `{self.port}`"

    @property
    def label(self) -> str:
        return f"writes `{self.port}` until the loop ends"

    @property
    def help(self) -> str:
        return f"write what `{self.port}` is to be afterwards: `(…) ; {self.port} ! {self.release}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.port_span, "a sampled output keeps its value until it is written again"),)
