"""The results of the timing analysis."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.task import Task
from cspdiag.analyses.timing.threads.graph import Missing
from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import rounded


@record
class LoopTiming:
    """One sampled loop; times are in nanoseconds from the nominal release, the tick.

    ``work`` is the execution time for a sample, including that of partners for which the loop waits. ``response`` and
    ``start`` are None where there is no bound. ``outputs`` are the sampled outputs of the program that it writes;
    ``latency`` is the shortest and the longest time from the sample to the outputs, None without outputs. ``leaves``
    are the paths of the laws and processes that take part.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    name: str
    thread: str
    span: Span
    period: int
    priority: int
    work: int
    step: int
    blocking: int
    response: int | None
    start: int | None
    outputs: tuple[str, ...]
    latency: tuple[int, int] | None
    partners: tuple[str, ...]
    leaves: frozenset[str]
    task: Task

    @property
    def utilization(self) -> float:
        """Share of the processor."""
        return self.work / self.period

    @property
    def slack(self) -> int | None:
        """What remains of the period in the worst case; not positive if the period is too short."""
        return None if self.response is None else self.period - self.response

    @property
    def is_met(self) -> bool:
        """Whether every output is computed before the next sample comes."""
        return self.response is not None and self.response <= self.task.deadline

    @property
    def jitter(self) -> int | None:
        """How much the latency varies."""
        return None if self.latency is None else self.latency[1] - self.latency[0]


@record
class Chain:
    """A path from an input of the program through loops to an output.

    ``reaction`` is the longest time from a change of the input to the first output that reflects it; ``age`` is the
    largest age of a sample when an output that is based on it is handed over. Each is None where it has no bound;
    ``unbounded`` says why, and where.
    """

    source: str
    sink: str
    loops: tuple[str, ...]
    reaction: int | None
    age: int | None
    unbounded: Refusal | None = None


@record
class Witness:
    """A sample of a thread that is late when every law takes its longest time; instants are in nanoseconds from the
    start of the program.

    ``end`` is the end of its work, None where it has not been taken before the next one arrives. ``next_release`` is
    the instant of that one.
    """

    thread: str
    release: int
    next_release: int
    end: int | None


@record
class TimingReport:
    """The timing of a whole program.

    ``advice`` lists the threads from the most to the least urgent, in an order that is proved to meet all deadlines
    where the present one is not. ``is_edf_feasible`` says whether earliest deadline first would meet them, None where
    that is not known. ``tasks`` are the tasks that were analysed. ``are_all_chains`` is False if there are too many
    chains to follow. ``witness`` is a late sample, if one is known; ``is_overloaded`` means that there is certainly
    more work than time. ``kernel`` is the measured time of the kernel at an instant, in nanoseconds, and
    ``kernel_ticks`` its work at ticks of ports, steps of environments and polls.
    """

    process: str
    loops: tuple[LoopTiming, ...]
    chains: tuple[Chain, ...]
    missing: tuple[Missing, ...]
    refusals: tuple[Refusal, ...]
    tasks: tuple[Task, ...]
    utilization: float
    hyperperiod: int
    is_edf_feasible: bool | None
    advice: tuple[str, ...] | None
    measured: tuple[str, ...] = ()
    are_all_chains: bool = True
    witness: Witness | None = None
    is_overloaded: bool = False
    kernel: int = 0
    kernel_ticks: tuple[Task, ...] = ()

    @property
    def is_schedulable(self) -> bool | None:
        """True if proved, False if a loop is late when every law takes its longest time, None if neither is known."""
        if self.missing or self.refusals:
            return None
        if all(loop.is_met for loop in self.loops):
            return True
        return False if self.is_overloaded or self.witness is not None else None

    @property
    def reason(self) -> str:
        """The verdict as a sentence."""
        if self.missing:
            first, others = self.missing[0], len(self.missing) - 1
            more = f" (and {others} more)" if others else ""
            return f"`{first.leaf}`{more} does not say its worst-case execution time"
        if self.refusals:
            return f"`{self.refusals[0].subject}`: {self.refusals[0].reason}"
        late = [loop.name for loop in self.loops if not loop.is_met]
        if late and self.witness is not None:
            name = self.witness.thread.partition(".")[2] or self.witness.thread
            end = self.witness.end
            what = "not taken before the next one comes" if end is None else f"ready at t = {rounded(end)}"
            what += ", when the next one comes" if end == self.witness.next_release else ""
            when = f"the sample of t = {rounded(self.witness.release)}"
            return f"`{name}` is late: when every law takes its longest time, {when} is {what}"
        if late and self.is_overloaded:
            return f"{_listed(late)} cannot always be ready before the next sample: there is more work than time"
        if late:
            # Another analysis may know of a late sample: W0707 may report missed ones.
            return (
                f"{_listed(late)} may not be ready before the next sample, though response times alone show no run in "
                "which it is late"
            )
        if not self.loops:
            return "no loop follows a sample period"
        return (
            f"all {len(self.loops)} sampled loops are ready before their next samples"
            if len(self.loops) > 1
            else (f"`{self.loops[0].name}` is ready before its next sample")
        )


def _listed(names: list[str]) -> str:
    shown = ", ".join(f"`{name}`" for name in names[:3])
    return shown + (f" and {len(names) - 3} more" if len(names) > 3 else "")
