"""What is wrong between processes of different rates."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.model.durations import duration


@record
class FasterLawWaits(Diagnostic):
    """Two control laws of different rates wait for each other.

    In a rendezvous the writer and the reader both wait. A law that is run at every sample of 1 ms and gets its set-point by
    rendezvous from a law that runs every 10 ms waits those 10 ms too. The samples that come meanwhile are overwritten, which is a missed
    deadline: `Timeout`. A FIFO only postpones it: an empty one makes the reader wait, and `buffer`, when full, the writer.

    To a faster reader the value has to be a variable: an alternative takes a new value when there is one, and runs the law at each sample
    with the last. A faster writer need not wait where the channel is `overwrite 1`: the slower reader takes the latest value.

    Refused::

        submodel Controller {
          in  wanted, actual : double
          out control        : double
          control = 2 * (wanted - actual)
        }

        process Main {
          in  wanted, angle : double @ 10 ms
          in  speed         : double @ 1 ms
          out control       : double @ 1 ms
          communication {
            outer : Controller
            inner : Controller
            wanted        -> outer.wanted
            angle         -> outer.actual
            outer.control -> inner.wanted
            speed         -> inner.actual
            inner.control -> control
          }
          composition { mu outer || mu inner }
        }

    Mended::

        submodel Controller {
          in  wanted, actual : double
          out control        : double
          control = 2 * (wanted - actual)
        }

        process Main {
          in  wanted, angle : double @ 10 ms
          in  speed         : double @ 1 ms
          out control       : double @ 1 ms
          communication {
            outer : Controller
            inner : Controller
            channel reference : double
            var target        : double = 0
            wanted        -> outer.wanted
            angle         -> outer.actual
            outer.control -> reference
            target        -> inner.wanted
            speed         -> inner.actual
            inner.control -> control
          }
          composition { mu outer || mu (reference ? target -> skip []> speed -> inner) }
        }
    """

    code = "W0706"
    title = "faster control law that waits for a slower one"
    severity = "warning"

    law: str
    port: str
    period: int
    sampled: str
    sampled_span: Span
    slower: str
    slower_port: str
    slower_period: int
    slower_span: Span
    is_writer: bool
    """Whether the faster law writes."""

    @property
    def message(self) -> str:
        every, slowly = duration(self.period), duration(self.slower_period)
        if self.is_writer:
            return (
                f"`{self.law}` runs every {every} but waits until `{self.slower}`, which runs every {slowly}, "
                f"takes `{self.port}`: it will miss samples of `{self.sampled}`"
            )
        return (
            f"`{self.law}` runs every {every} but waits for `{self.slower_port}`, which comes every {slowly}: "
            f"it will miss samples of `{self.sampled}`"
        )

    @property
    def help(self) -> str | None:
        if self.is_writer:
            return "let the channel keep the latest value: `overwrite 1` on this relationship, without waiting for the reader"
        return (
            f"connect a variable to `{self.port}`, and read the slow value into it when it comes: "
            f"`mu (channel ? variable -> skip []> {self.sampled} -> {self.law.rpartition('.')[2]})`"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.sampled_span, f"`{self.law}` takes a sample every {duration(self.period)}"),
            Label(self.slower_span, f"`{self.slower}` takes a sample every {duration(self.slower_period)}"),
        )
