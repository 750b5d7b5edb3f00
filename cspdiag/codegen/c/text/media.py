"""Channels, ports and reading ends in C: the types of the kernel for them."""

from __future__ import annotations

from typing import Literal, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import Code, address, member_of
from cspdiag.model.types import Type
from cspdiag.network.ir.network import LocalChannel, Medium, Port

Access: TypeAlias = Literal[
    "variable", "constant", "discard", "channel", "guarded", "any", "broadcast", "buffer",
    "sampled", "event", "latched", "direct",
]  # fmt: skip
"""A rendezvous of one reader and one writer is a ``channel`` without guards, and ``guarded`` if only the reader has
guards; ``any`` is every other rendezvous.
"""


@record
class EndInC:
    """An end as it is written in step functions.

    ``pointer`` is a pointer to the channel, port or reading end; for a variable or constant it is the lvalue.
    ``member`` is the argument for ``offsetof``; with ``indirect``, that member is a pointer. ``name`` occurs in the
    names of states.
    """

    access: Access
    pointer: Code
    member: Code
    indirect: bool
    type: Type
    name: str
    written: Code | None = None
    """A pointer to the flag whether a variable was written; None if it always is before it is read."""

    @property
    def never_waits(self) -> bool:
        """Whether communicating at this end never waits."""
        return self.access in ("variable", "constant", "discard", "latched", "direct")

    @property
    def medium(self) -> Code:
        """A pointer to the ``csp_medium`` at the beginning of the object."""
        if self.access == "guarded":
            return address(member_of(self.pointer, "channel").field("medium"))
        return address(member_of(self.pointer, "medium"))


def _rendezvous(*, guarded_reads: bool, guarded_writes: bool) -> Access:
    if guarded_writes:
        return "any"
    return "guarded" if guarded_reads else "channel"


def access_of(medium: LocalChannel | Medium) -> Access:
    """The access to a channel of a class, or to the medium behind a port."""
    match medium.kind:
        case "var":
            return "variable"
        case "sync":
            return _rendezvous(guarded_reads=medium.guarded_reads, guarded_writes=medium.guarded_writes)
        case "overwrite":
            return "buffer"
        case "broadcast" | "any" | "buffer" | "sampled" | "event" | "latched" | "direct" | "constant" | "discard":
            return medium.kind
    assert_never(medium.kind)


def accesses(port: Port) -> tuple[Access, ...]:
    """The access of a port, or of each element of an array of ports."""
    return tuple(access_of(medium) for medium in port.media)


def port_type(access: Access, type_name: str, *, writes: bool) -> str | None:
    """The C type of a port, up to the name of the member; None if it needs no member."""
    match access:
        case "variable":
            return f"{type_name} *" if writes else f"const {type_name} *"
        case "constant":
            return f"{type_name} "
        case "discard":
            return None
        case "channel":
            return "csp_channel *"
        case "guarded":
            return "csp_guarded_channel *"
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
        case "guarded":
            return "csp_guarded_channel"
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
"""The types of reading ends: media for which each reader needs an object of its own."""
