"""What the timing analysis finds: loops that are late, and those of which it is not known."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class NotSchedulable(Diagnostic):
    """A sampled loop does not have its outputs ready before its next sample when every law takes the longest time that it states.

    It waits for everything that is more urgent, for a step of what is less urgent (a step runs until its process waits,
    and nothing preempts it), and for all of equal priority that came first. An output is then a period late, and soon
    samples are missed. Shorter execution times, longer periods, another order of priorities (`||>`) or shorter steps help; `cspdiag verify --timing`
    shows the sum for every loop, and whether another order would do.

    Refused::

        submodel Fast wcet 600 us {
          in  x : double
          out y : double
          y = 2 * x
        }

        submodel Slow wcet 900 us {
          in  x : double
          out y : double
          y = 3 * x
        }

        process Both {
          in  a, b : double @ 10 ms
          in  c    : double @ 1 ms
          out p    : double @ 10 ms
          out q    : double @ 1 ms

          communication {
            slow : Slow
            fast : Fast

            a -> slow.x
            c -> fast.x
            b -> _
            slow.y -> p
            fast.y -> q
          }

          composition { mu fast ||> mu slow }
        }

        assert Both schedulable

    Mended::

        submodel Fast wcet 600 us {
          in  x : double
          out y : double
          y = 2 * x
        }

        submodel Slow wcet 300 us {
          in  x : double
          out y : double
          y = 3 * x
        }

        process Both {
          in  a, b : double @ 10 ms
          in  c    : double @ 1 ms
          out p    : double @ 10 ms
          out q    : double @ 1 ms

          communication {
            slow : Slow
            fast : Fast

            a -> slow.x
            c -> fast.x
            b -> _
            slow.y -> p
            fast.y -> q
          }

          composition { mu fast ||> mu slow }
        }

        assert Both schedulable
    """

    code = "E1106"
    title = "a loop that is late"

    process: str
    reason: str
    loops: tuple[tuple[str, str, str, Span], ...]
    """Name, period, worst response in words, and place of each loop that may be late."""
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.process}` is not schedulable: {self.reason}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(
            Label(place, f"`{name}` has {period} and may take {response}")
            for name, period, response, place in self.loops[:4]
        )


@record
class NoTimingBound(Diagnostic):
    """Whether a process is schedulable cannot be said: something has no bound, or a bound is longer than the period though no run is known that is late.

    A law says how long it computes at most in its head, `wcet 120 us`; so does a process whose code is written by hand, of what it computes from one wait to the next.
    All laws that run on the processor have to say it, since any of them may delay the others. A loop must not wait without bound between its samples either, for
    an event or for a partner that may itself be waiting for something else.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          y = 2 * x
        }

        process Main {
          in  x : double @ 1 ms
          out y : double @ 1 ms

          communication {
            law : Law

            x     -> law.x
            law.y -> y
          }

          composition { mu law }
        }

        assert Main schedulable

    Mended::

        submodel Law wcet 120 us {
          in  x : double
          out y : double
          y = 2 * x
        }

        process Main {
          in  x : double @ 1 ms
          out y : double @ 1 ms

          communication {
            law : Law

            x     -> law.x
            law.y -> y
          }

          composition { mu law }
        }

        assert Main schedulable
    """

    code = "E1107"
    title = "not known to be in time"

    process: str
    reason: str
    places: tuple[tuple[str, Span], ...]
    """What stands in the way, in words, with its place."""
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"whether `{self.process}` is schedulable cannot be said: {self.reason}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, words) for words, place in self.places[:6])
