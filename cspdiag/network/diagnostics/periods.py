"""What is wrong with sample periods."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


@record
class PeriodNotPositive(Diagnostic):
    """A sample period is zero or negative.

    Sampled ports communicate at the instants k·T, k = 1, 2, … There are such instants only for a period longer than zero.

    What is marked is where the period comes from: the constant or the argument that gives it to every port further in. With
    `--set` the value is the one of the command line, and the constant or parameter that was set is marked.

    Refused::

        const T = 0 ms

        process Main {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }

    Mended::

        const T = 1 ms

        process Main {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }
    """

    code = "E0701"
    title = "sample period that is not positive"

    period: int
    use: Span
    """The port that has it."""
    is_set: bool
    """Whether the value was given from outside, to the name at ``span``."""

    @property
    def message(self) -> str:
        return f"a sample period of {duration(self.period)} is not possible: it must be longer than zero"

    @property
    def label(self) -> str:
        return f"set to {duration(self.period)}" if self.is_set else ""

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.use == self.span else (Label(self.use, "the sample period here"),)


@record
class PeriodsDisagree(Diagnostic):
    """Ports with different sample periods are connected to each other.

    A net has one period: its values come at the instants of one clock. A port inside that says another period would wait for samples
    that do not come, or miss those that do.

    Refused::

        process Reader(T: time) {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }

        process Main {
          in angle : int @ 1 ms
          communication {
            reader : Reader(T = 2 ms)
            angle -> reader.angle
          }
          composition { reader }
        }

    Mended::

        process Reader(T: time) {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }

        process Main {
          in angle : int @ 1 ms
          communication {
            reader : Reader(T = 1 ms)
            angle -> reader.angle
          }
          composition { reader }
        }
    """

    code = "E0702"
    title = "two sample periods on one net"

    net: str
    one: int
    one_span: Span
    other: int
    other_span: Span

    @property
    def message(self) -> str:
        return f"`{self.net}` is sampled every {duration(self.one)} and connects a port sampled every {duration(self.other)}"

    @property
    def help(self) -> str | None:
        return "give both ends the same period; between two rates, a process must read at one and write at the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.one_span, f"{duration(self.one)} here"),
            Label(self.other_span, f"{duration(self.other)} here"),
        )


@record
class SampledInsideOnly(Diagnostic):
    """An event port of the outermost process is sampled further in.

    On the outermost process a port without `@` is an event port: it is ready when the environment offers something new. A process inside
    that expects a sample at every period would miss its deadlines.

    Refused::

        process Reader(T: time) {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }

        process Main {
          in angle : int
          communication {
            reader : Reader(T = 1 ms)
            angle -> reader.angle
          }
          composition { reader }
        }

    Mended::

        process Reader(T: time) {
          in angle : int @ T
          communication { var last : int = 0 }
          composition { mu angle ? last }
        }

        process Main {
          in angle : int @ 1 ms
          communication {
            reader : Reader(T = 1 ms)
            angle -> reader.angle
          }
          composition { reader }
        }
    """

    code = "E0703"
    title = "event port used as a sampled one"

    port: str
    period: int
    inner: Span

    @property
    def message(self) -> str:
        return (
            f"`{self.port}` of the outermost process has no period, so it is an event port, "
            f"but inside it is sampled every {duration(self.period)}"
        )

    @property
    def help(self) -> str | None:
        return "say `@` and the period at this port too"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.inner, "sampled here"),)


@record
class SampleUnknown(Diagnostic):
    """A control law needs its sample period, and nothing tells it.

    A submodel runs at the period of the nets that it is connected to: those with a port that says `@ T`, or else that of the submodel with
    which it exchanges values. A law with derivatives, or with `sample` in its equations, means nothing without a period.

    Refused::

        submodel Filter {
          in  input  : double
          out output : double
          state last : double = 0
          output    = last
          next last = input + sample / 1 s * last
        }

        process Main {
          in  raw    : double
          out smooth : double
          communication {
            filter : Filter
            raw           -> filter.input
            filter.output -> smooth
          }
          composition { mu filter }
        }

    Mended::

        submodel Filter {
          in  input  : double
          out output : double
          state last : double = 0
          output    = last
          next last = input + sample / 1 s * last
        }

        process Main {
          in  raw    : double @ 1 ms
          out smooth : double @ 1 ms
          communication {
            filter : Filter
            raw           -> filter.input
            filter.output -> smooth
          }
          composition { mu filter }
        }
    """

    code = "E0704"
    title = "sample period that cannot be inferred"

    instance: str
    definition: str

    @property
    def message(self) -> str:
        return f"`{self.instance}` needs its sample period, but no port with a period (`@ T`) is connected to it"

    @property
    def label(self) -> str:
        return f"`{self.definition}` has states or operators that depend on the period"

    @property
    def help(self) -> str | None:
        return "say `@` and the period at the port of the process that it reads or writes"


@record
class SamplesDisagree(Diagnostic):
    """A control law is connected to nets of two sample periods.

    One run of a submodel reads all its inputs and writes all its outputs once, so that it has one period. At the faster of
    two it would wait for the slower input, and miss samples. A process at the boundary of two rates reads the slow value into a variable
    when it comes, and runs the law with what it has.

    Refused::

        submodel Difference {
          in  wanted, actual : double
          out error : double
          error = wanted - actual
        }

        process Main {
          in  wanted : double @ 10 ms
          in  actual : double @ 1 ms
          out error  : double @ 1 ms
          communication {
            law : Difference
            wanted    -> law.wanted
            actual    -> law.actual
            law.error -> error
          }
          composition { mu law }
        }

    Mended::

        submodel Difference {
          in  wanted, actual : double
          out error : double
          error = wanted - actual
        }

        process Main {
          in  wanted : double @ 10 ms
          in  actual : double @ 1 ms
          out error  : double @ 1 ms
          communication {
            law : Difference
            var target : double = 0
            target    -> law.wanted
            actual    -> law.actual
            law.error -> error
          }
          composition {
            mu (
              wanted ? target -> skip
              []>
              actual -> law
            )
          }
        }
    """

    code = "E0705"
    title = "control law between two sample periods"

    instance: str
    one: int
    one_span: Span
    other: int
    other_span: Span

    @property
    def message(self) -> str:
        return (
            f"`{self.instance}` is connected to a net sampled every {duration(self.one)} "
            f"and to one sampled every {duration(self.other)}, but one run takes one sample of each"
        )

    @property
    def help(self) -> str | None:
        return "keep the slower value in a variable (`port ? x`), and connect the variable"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.one_span, f"{duration(self.one)} here"),
            Label(self.other_span, f"{duration(self.other)} here"),
        )
