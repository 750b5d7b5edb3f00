"""What is wrong with sample periods."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration
from cspdiag.model.sampling import Sampling


@record
class PeriodNotPositive(Diagnostic):
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
    code = "E0702"
    title = "two sample periods or offsets on one net"

    net: str
    one: Sampling
    one_span: Span
    other: Sampling
    other_span: Span

    @property
    def message(self) -> str:
        return f"`{self.net}` is sampled {self.one.every} and connects a port sampled {self.other.every}"

    @property
    def help(self) -> str | None:
        if self.one.period == self.other.period:
            return (
                "give both ends the same offset, or leave out the `@` of the inner one, which is sampled as its net is"
            )
        return "give both ends the same period; between two rates, a process must read at one and write at the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.one_span, f"{self.one} here"),
            Label(self.other_span, f"{self.other} here"),
        )


@record
class SampledInsideOnly(Diagnostic):
    code = "E0703"
    title = "event port used as a sampled one"
    help = "write `@` and the period at this port too"

    port: str
    sampling: Sampling
    inner: Span

    @property
    def message(self) -> str:
        return (
            f"`{self.port}` of the outermost process has no period, so it is an event port, "
            f"but inside it is sampled {self.sampling.every}"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.inner, "sampled here"),)


@record
class SampleUnknown(Diagnostic):
    code = "E0704"
    title = "sample period that cannot be inferred"
    help = "write `@` and the period at the port of the process that it reads or writes"

    instance: str
    definition: str

    @property
    def message(self) -> str:
        return f"`{self.instance}` needs its sample period, but no port with a period (`@ T`) is connected to it"

    @property
    def label(self) -> str:
        return f"`{self.definition}` has states or operators that depend on the period"


@record
class OffsetOutsidePeriod(Diagnostic):
    code = "E0708"
    title = "offset of samples outside the period"

    offset: int
    period: int

    @property
    def message(self) -> str:
        wrong = "negative" if self.offset < 0 else "not shorter than the period"
        return f"an offset of {duration(self.offset)} is {wrong}: samples every {duration(self.period)} cannot have it"

    @property
    def help(self) -> str | None:
        rest = self.offset % self.period
        if not rest:
            return "leave it out: samples come at the multiples of the period"
        return f"say where in the period the samples lie: with `offset {duration(rest)}` they come at the same instants"


@record
class SamplesDisagree(Diagnostic):
    code = "E0705"
    title = "control law between two sample periods"
    help = "keep the slower value in a variable (`port ? x`), and connect the variable"

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
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.one_span, f"{duration(self.one)} here"),
            Label(self.other_span, f"{duration(self.other)} here"),
        )
