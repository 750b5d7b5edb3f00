"""What is wrong between the users of a channel: in sequence, in parallel, or both."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.network.relations import Access, Pair
from cspdiag.syntax import ast


def _both(one: Access, other: Access, verbs: tuple[str, str]) -> tuple[Label, ...]:
    """The places of a pair: the other end of the relationship, and where the two stand in the composition."""
    labels = [Label(other.span, f"{other.who} {verbs[1]} here")]
    for access, verb in ((one, verbs[0]), (other, verbs[1])):
        if access.run != access.span:
            labels.append(Label(access.run, f"{access.who}, which {verb} it, runs here"))
    return tuple(labels)


@record
class Race(Diagnostic):
    """E0520."""

    code = "E0520"
    title = "race on a variable"

    variable: str
    one: Access
    other: Access
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.variable}` is written by {self.one.who} in parallel with {self.other.who}, which uses it too"

    @property
    def label(self) -> str:
        return "written here"

    @property
    def help(self) -> str | None:
        return "pass the value over a channel between the two, or run them one after the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("writes", "uses"))


@record
class ParallelWriters(Diagnostic):
    """E0521."""

    code = "E0521"
    title = "several writers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None
    outermost: bool

    @property
    def message(self) -> str:
        return f"{self.one.who} and {self.other.who} write `{self.channel}` in parallel"

    @property
    def help(self) -> str | None:
        if self.said is not None:
            return f"only `any` takes values from several writers, one at a time; this channel says `{self.said}`"
        if self.outermost:
            return "write `-> any ->` if the values may come in any order, or run one writer after the other"
        return "write `-> any ->` so that the channel takes from one writer at a time, or run them one after the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("writes", "writes"))


@record
class ParallelReaders(Diagnostic):
    """E0522."""

    code = "E0522"
    title = "several readers in parallel"

    channel: str
    one: Access
    other: Access
    said: str | None

    @property
    def message(self) -> str:
        return f"{self.one.who} and {self.other.who} read `{self.channel}` in parallel"

    @property
    def help(self) -> str | None:
        said = "" if self.said is None else f" instead of `{self.said}`"
        return f"say `broadcast` (each of them gets every value) or `any` (one of them gets it){said}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("reads", "reads"))


@record
class EventReadInParallel(Diagnostic):
    """E0523."""

    code = "E0523"
    title = "event read by several in parallel"

    port: str
    one: Access
    other: Access
    declared: Span

    @property
    def message(self) -> str:
        return (
            f"the event `{self.port}` is read by {self.one.who} and {self.other.who} in parallel, "
            "so that one can take it from the other"
        )

    @property
    def help(self) -> str | None:
        return "write `-> broadcast ->` if each of them must get every event, `-> any ->` if one of them is enough"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (*_both(self.one, self.other, ("reads", "reads")), Label(self.declared, "the event port"))


@record
class MixedRelation(Diagnostic):
    """E0524."""

    code = "E0524"
    title = "users of a channel both in sequence and in parallel"

    channel: str
    parallel: Pair
    sequential: Pair

    @property
    def message(self) -> str:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            f"`{self.channel}` passes values between {writer.who} and {reader.who}, which are in parallel, "
            f"and between {earlier.who} and {later.who}, which are in sequence"
        )

    @property
    def help(self) -> str | None:
        return "give each pair a channel of its own: one that waits for the partner, and one that keeps a value"

    @property
    def labels(self) -> tuple[Label, ...]:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            Label(writer.run, f"{writer.who} writes in parallel with {reader.who}"),
            Label(earlier.run, f"{earlier.who} writes"),
            Label(later.run, f"{later.who} reads in sequence with it"),
        )


@record
class KindsDisagree(Diagnostic):
    """E0525."""

    code = "E0525"
    title = "two kinds for one channel"

    channel: str
    kind: str
    other: ast.Kind

    @property
    def message(self) -> str:
        return f"`{self.channel}` is said to be `{self.kind}` here and `{self.other.name}` elsewhere"

    @property
    def help(self) -> str | None:
        return "a channel has one kind: say the same, or leave it away in one of the places"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other.span, f"`{self.other.name}` here"),)


@record
class RendezvousInSequence(Diagnostic):
    """E0526."""

    code = "E0526"
    title = "channel that waits, between parts in sequence"

    channel: str
    kind: str
    writer: Access
    reader: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `{self.kind}`, but {self.writer.who} and {self.reader.who} run in sequence: "
            "each would wait for the other for ever"
        )

    @property
    def help(self) -> str | None:
        return f"leave `{self.kind}` away, so that the channel keeps the value, or put the two in parallel"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.writer.run, f"{self.writer.who} writes here"),
            Label(self.reader.run, f"{self.reader.who} reads here"),
        )


@record
class BroadcastInSequence(Diagnostic):
    """E0527."""

    code = "E0527"
    title = "broadcast to readers in sequence"

    channel: str
    one: Access
    other: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `broadcast`, but {self.one.who} and {self.other.who} read it in sequence: "
            "the writer would wait for both at once"
        )

    @property
    def help(self) -> str | None:
        return "put the readers in parallel, or say `any` if each value goes to whichever of them runs"

    @property
    def labels(self) -> tuple[Label, ...]:
        return _both(self.one, self.other, ("reads", "reads"))


@record
class KindContradicts(Diagnostic):
    """E0528."""

    code = "E0528"
    title = "kind that a port of the outermost process cannot have"

    port: str
    kind: str
    direction: str
    sampled: bool
    declared: Span

    @property
    def message(self) -> str:
        if self.direction == "out":
            return f"the output `{self.port}` of the outermost process cannot be `{self.kind}`"
        if self.sampled:
            return f"the sampled input `{self.port}` cannot be `{self.kind}`: every reader gets every sample"
        return f"the event input `{self.port}` cannot be `{self.kind}`: it keeps the latest event until it is read"

    @property
    def help(self) -> str | None:
        if self.direction == "out":
            return "leave the kind away, or say `any` where several write it in parallel"
        if self.sampled:
            return "leave the kind away"
        return "say `broadcast` or `any` where several read it in parallel, and nothing otherwise"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)


@record
class ChannelOneSided(Diagnostic):
    """E0529."""

    code = "E0529"
    title = "channel with one side only"

    channel: str
    used: Access | None

    @property
    def message(self) -> str:
        if self.used is None:
            return f"the channel `{self.channel}` is never used"
        return f"the channel `{self.channel}` has only one side: nobody is there to take or give what passes"

    @property
    def help(self) -> str | None:
        return "let one process write it with `!` and another in parallel read it with `?`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.used is None else (Label(self.used.span, "the only use"),)


@record
class ChannelReadAsVariable(Diagnostic):
    """E0530."""

    code = "E0530"
    title = "value of a channel that keeps none"

    channel: str
    kind: str
    declared: Span

    @property
    def message(self) -> str:
        return f"`{self.channel}` is a `{self.kind}` channel between parallel parts and keeps no value to be looked at"

    @property
    def help(self) -> str | None:
        return f"read it into a variable with `{self.channel} ? x`, and use the variable"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the channel"),)


@record
class LabelOfPortRead(Diagnostic):
    """E0531."""

    code = "E0531"
    title = "value of a port"

    name: str
    port: str
    declared: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` names the relationship at the port `{self.port}`, which keeps no value to be looked at"

    @property
    def help(self) -> str | None:
        return f"read the port into a variable with `{self.port} ? x`, and use the variable"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"the port `{self.port}`"),)
