"""What priorities exclude in a replay: guards that come after others which are ready, and processes that get on before more urgent ones."""

from __future__ import annotations

from collections.abc import Container, Iterable

from cspdiag.simulate.replay_gates import Gate, Option

_LEFT_OUT = ", and proofs leave priorities out"


def excluded(gate: Gate, option: Option, halted: Iterable[Gate], outside: Container[str]) -> str | None:
    """Why a process cannot go on with an option now, where ``halted`` are all that halt; None if it can.

    ``outside`` are the channels of the environment, which may always come later.
    """
    waiting = tuple(halted)
    for other in gate.options if gate.prioritized else ():
        if other == option:
            break
        comes = other.channel not in outside and gate.is_ready(other)
        if other.action == "skip" or comes or _offered_above(other, gate, waiting):
            preferred, later = other.channel or other.action, option.channel or option.action
            return f"`{gate.path}` prefers `{preferred}` to `{later}`{_LEFT_OUT}"
    for first in waiting:
        for second in waiting:
            if first is not second and _meet_above(first, second, gate):
                channel = next(option.channel for option in first.options if option.action == "write")
                return f"`{channel}` comes first: each of its processes has a higher priority{_LEFT_OUT}"
    return None


def _offered_above(option: Option, gate: Gate, waiting: tuple[Gate, ...]) -> bool:
    """Whether a process of higher priority waits at the other side of a guard."""
    opposite = "read" if option.action == "write" else "write"
    return any(
        other.priority < gate.priority
        and any((entry.action, entry.channel) == (opposite, option.channel) for entry in other.options)
        for other in waiting
    )


def _meet_above(writer: Gate, reader: Gate, gate: Gate) -> bool:
    """Whether two processes of higher priority than that of ``gate`` would communicate before it gets on."""
    if len(writer.options) != 1 or len(reader.options) != 1:
        return False
    (written,), (read,) = writer.options, reader.options
    meet = (written.action, read.action, written.channel) == ("write", "read", read.channel)
    return meet and max(writer.priority, reader.priority) < gate.priority
