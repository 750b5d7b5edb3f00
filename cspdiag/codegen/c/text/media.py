"""What ends are in C: the kernel's types for channels, ports and reading ends."""

from __future__ import annotations

from typing import Literal, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import Code, address, member_of
from cspdiag.model.types import Type
from cspdiag.network.ir.network import LocalChannel, Medium, Port

Access: TypeAlias = Literal[
    "variable", "constant", "discard", "channel", "any", "broadcast", "buffer", "sampled", "event", "latched", "direct"
]
"""``channel`` is a rendezvous of one reader and one writer without guards, ``any`` every other rendezvous."""


@record
class Spelling:
    """An end as step functions write it.

    ``pointer`` is a pointer to the channel, port or reading end; of a variable or constant the lvalue. ``member`` is
    what ``offsetof`` names, where ``indirect`` says that a pointer stands there. ``name`` is what states are called
    after.
    """

    access: Access
    pointer: Code
    member: Code
    indirect: bool
    type: Type
    name: str
    written: Code | None = None
    """A pointer to the flag whether a variable was written, where that is not sure."""

    @property
    def at_once(self) -> bool:
        """Whether it never waits."""
        return self.access in ("variable", "constant", "discard", "latched", "direct")

    @property
    def medium(self) -> Code:
        """A pointer to the ``csp_medium`` that it begins with."""
        return address(member_of(self.pointer, "medium"))


def access_of_channel(channel: LocalChannel) -> Access:
    """What a channel of a class is."""
    match channel.kind:
        case "var":
            return "variable"
        case "sync":
            return "any" if channel.guarded_reads or channel.guarded_writes else "channel"
        case "overwrite":
            return "buffer"
        case "broadcast" | "any" | "buffer":
            return channel.kind
    assert_never(channel.kind)


def access_of_medium(medium: Medium) -> Access:
    """What a port is connected to."""
    match medium.kind:
        case "var":
            return "variable"
        case "sync":
            return "any" if medium.guarded_reads or medium.guarded_writes else "channel"
        case "overwrite":
            return "buffer"
        case "broadcast" | "any" | "buffer" | "sampled" | "event" | "latched" | "direct" | "constant" | "discard":
            return medium.kind
    assert_never(medium.kind)


def accesses(port: Port) -> tuple[Access, ...]:
    """Of a port, or of every element of an array of ports."""
    return tuple(access_of_medium(medium) for medium in port.media)


def port_type(access: Access, type_name: str, *, writes: bool) -> str | None:
    """The C type of a port, up to the name of the member; None where nothing is needed."""
    match access:
        case "variable":
            return f"{type_name} *" if writes else f"const {type_name} *"
        case "constant":
            return f"{type_name} "
        case "discard":
            return None
        case "channel":
            return "csp_channel *"
        case "any":
            return "csp_any_channel *"
        case "broadcast":
            return "csp_broadcast *"
        case "buffer":
            return "csp_buffer *"
        case "sampled":
            return "csp_sampled_input *"
        case "event":
            return "csp_event_input *"
        case "latched":
            return "csp_latched_output *"
        case "direct":
            return "csp_direct_output *"
    assert_never(access)


def channel_type(access: Access, type_name: str) -> str:
    """The C type of a channel that a class owns."""
    match access:
        case "variable":
            return type_name
        case "channel":
            return "csp_channel"
        case "any":
            return "csp_any_channel"
        case "broadcast":
            return "csp_broadcast"
        case "buffer":
            return "csp_buffer"
        case "constant" | "discard" | "sampled" | "event" | "latched" | "direct":
            raise ValueError(f"no class owns a {access}")
        case _:
            assert_never(access)


READING_ENDS: dict[Access, str] = {
    "sampled": "csp_sampled_end",
    "broadcast": "csp_broadcast_end",
    "event": "csp_event_end",
}
"""What a reader needs an object of its own for."""
