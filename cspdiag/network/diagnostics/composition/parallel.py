"""What goes wrong between users of a channel in parallel."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Access


def _do_in_parallel(one: Access, other: Access, verb: str, channel: str) -> str:
    """Who does the same to a channel at the same time: ```one` and `other` read `c` in parallel``."""
    if not one.instance and not other.instance:
        return f"two parallel parts of the process {verb} `{channel}`"
    return f"{one.user} and {other.user} {verb} `{channel}` in parallel"


def both(one: Access, other: Access, verbs: tuple[str, str]) -> tuple[Label, ...]:
    """The places of a pair: the other end of the relationship, and where the two are in the composition."""
    labels = [Label(other.span, f"{other.user} {verbs[1]} here")]
    for access, verb in ((one, verbs[0]), (other, verbs[1])):
        if access.run != access.span:
            labels.append(Label(access.run, f"{access.user}, which {verb} it, runs here"))
    return tuple(labels)


@record
class Race(Diagnostic):
    code = "E0520"
    title = "race on a variable"
    label = "written here"
    help = "pass the value over a channel between the two, or run them one after the other"

    variable: str
    one: Access
    other: Access
    both_write: bool

    @property
    def message(self) -> str:
        if self.both_write:
            writing = _do_in_parallel(self.one, self.other, "write", self.variable)
            return f"{writing}, so that either value may be lost"
        if not self.one.instance and not self.other.instance:
            return f"`{self.variable}` is written in one parallel part of the process and read in another"
        return f"{self.one.user} writes `{self.variable}` in parallel with {self.other.user}, which reads it"

    @property
    def labels(self) -> tuple[Label, ...]:
        return both(self.one, self.other, ("writes", "writes" if self.both_write else "reads"))


@record
class ParallelWriters(Diagnostic):
    code = "E0521"
    title = "several writers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None
    outermost: bool

    @property
    def message(self) -> str:
        return _do_in_parallel(self.one, self.other, "write", self.channel)

    @property
    def help(self) -> str | None:
        if self.said is not None:
            return (
                f"only `any` takes values from several writers, one at a time; this channel is declared `{self.said}`"
            )
        if self.outermost:
            return "write `-> any ->` if the values may come in any order, or run one writer after the other"
        return "write `-> any ->` so that the channel takes from one writer at a time, or run them one after the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return both(self.one, self.other, ("writes", "writes"))


@record
class ParallelReaders(Diagnostic):
    code = "E0522"
    title = "several readers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None

    @property
    def message(self) -> str:
        return _do_in_parallel(self.one, self.other, "read", self.channel)

    @property
    def help(self) -> str | None:
        said = "" if self.said is None else f" instead of `{self.said}`"
        return f"write `broadcast` (each of them gets every value) or `any` (one of them gets it){said}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return both(self.one, self.other, ("reads", "reads"))


@record
class EventReadInParallel(Diagnostic):
    code = "E0523"
    title = "event read by several in parallel"
    help = "write `-> broadcast ->` if each of them must get every event, `-> any ->` if one of them is enough"

    port: str
    one: Access
    other: Access
    declared: Span

    @property
    def message(self) -> str:
        reading = _do_in_parallel(self.one, self.other, "read the event", self.port)
        return f"{reading}, so that one can take it from the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (*both(self.one, self.other, ("reads", "reads")), Label(self.declared, "the event port"))
