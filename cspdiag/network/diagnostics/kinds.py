"""Kinds of channels that do not fit the relations of their users."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Pair
from cspdiag.network.shapes import RequestedKind


@record
class MixedRelation(Diagnostic):
    code = "E0524"
    title = "users of a channel both in sequence and in parallel"
    help = "give each pair a channel of its own: one that waits for the partner, and one that keeps a value"

    channel: str
    parallel: Pair
    sequential: Pair

    @property
    def message(self) -> str:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            f"`{self.channel}` passes values between {writer.user} and {reader.user}, which are in parallel, "
            f"and between {earlier.user} and {later.user}, which are in sequence"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        writer, reader = self.parallel
        earlier, later = self.sequential
        return (
            Label(writer.run, f"{writer.user} writes in parallel with {reader.user}"),
            Label(earlier.run, f"{earlier.user} writes"),
            Label(later.run, f"{later.user} reads in sequence with it"),
        )


@record
class KindsDisagree(Diagnostic):
    code = "E0525"
    title = "two kinds for one channel"
    help = "a channel has one kind: write the same in both places, or remove one of them"

    channel: str
    kind: str
    other: RequestedKind

    @property
    def message(self) -> str:
        return f"`{self.channel}` is declared `{self.kind}` here and `{self.other.name}` elsewhere"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other.span, f"`{self.other.name}` here"),)


@record
class KindContradicts(Diagnostic):
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
            return "remove the kind, or write `any` where several write it in parallel"
        if self.sampled:
            return "remove the kind"
        return "write `broadcast` or `any` where several read it in parallel, and nothing otherwise"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)
