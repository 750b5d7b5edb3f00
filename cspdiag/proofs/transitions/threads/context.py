"""Contexts: the processes inside a thread."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.network import Attachment, ConstantEnd, DiscardEnd
from cspdiag.proofs.transitions.classes.program import Class
from cspdiag.proofs.transitions.occurrences import Occurrence
from cspdiag.proofs.transitions.systems.references import Constant, Discard, InnerChannel, Path, Reference


class Context:
    """A process inside a thread; its actions name their ports and channels in its terms."""

    __slots__ = ("_channels", "definition", "occurrence", "path", "ports")

    def __init__(self, path: Path, occurrence: Occurrence, ports: dict[tuple[str, int | None], Reference]) -> None:
        self.path = path
        self.occurrence = occurrence
        self.definition: Class = occurrence.definition
        self.ports = ports
        self._channels: dict[str, InnerChannel] = {}

    def reference(self, end: Attachment) -> Reference:
        """The medium that an end is attached to."""
        match end:
            case PortEnd():
                return self.ports[end.port, end.index]
            case ChannelEnd():
                return self.channel(end.channel)
            case ConstantEnd():
                return Constant(self.occurrence.constant(end.value))
            case DiscardEnd():
                return Discard()
            case _:
                assert_never(end)

    def channel(self, name: str) -> InnerChannel:
        """A channel of the process itself."""
        known = self._channels.get(name)
        if known is None:
            known = self._channels[name] = InnerChannel(self.path, name)
        return known
