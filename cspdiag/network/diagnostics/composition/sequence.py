"""What can be wrong with channels between parts of a program that follow one another."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label
from cspdiag.base.record import record
from cspdiag.network.diagnostics.composition.parallel import both
from cspdiag.network.relations import Access


@record
class RendezvousInSequence(Diagnostic):
    code = "E0526"
    title = "channel that waits, between parts in sequence"

    channel: str
    kind: str
    writer: Access
    reader: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `{self.kind}`, but {self.writer.user} and {self.reader.user} run in sequence: "
            "each would wait for the other forever"
        )

    @property
    def help(self) -> str | None:
        return f"remove `{self.kind}`, so that the channel keeps the value, or put the two in parallel"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.writer.run, f"{self.writer.user} writes here"),
            Label(self.reader.run, f"{self.reader.user} reads here"),
        )


@record
class BroadcastInSequence(Diagnostic):
    code = "E0527"
    title = "broadcast to readers in sequence"
    help = "put the readers in parallel, or write `any` if each value goes to whichever of them runs"

    channel: str
    one: Access
    other: Access

    @property
    def message(self) -> str:
        return (
            f"`{self.channel}` is `broadcast`, but {self.one.user} and {self.other.user} read it in sequence: "
            "the writer would wait for both at once"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return both(self.one, self.other, ("reads", "reads"))
