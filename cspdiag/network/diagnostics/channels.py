"""Diagnostics of channels without a side, and of channels that are used as if they kept a value."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Access


@record
class ChannelOneSided(Diagnostic):
    code = "E0529"
    title = "channel with one side only"
    help = "let one process write it with `!` and another in parallel read it with `?`"

    channel: str
    used: Access | None

    @property
    def message(self) -> str:
        if self.used is None:
            return f"the channel `{self.channel}` is never used"
        return f"the channel `{self.channel}` has only one side: no process reads or writes it on the other"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.used is None else (Label(self.used.span, "the only use"),)


@record
class ChannelReadAsVariable(Diagnostic):
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
