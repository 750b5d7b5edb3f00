"""The state of processes at the end of a replay: what they offer to the environment, and whether they can continue
without it.
"""

from __future__ import annotations

from collections.abc import Container, Iterable

from cspdiag.base.record import record
from cspdiag.runtime.kernel.policy import Option
from cspdiag.verify.replay.gates import Gate, Interruption

_BY_ITSELF = frozenset({"skip", "wait", "after"})


@record
class Resting:
    """``offers`` are options at ports of the outermost process; ``can_continue``: whether a process can continue by
    itself, or two with each other.
    """

    offers: tuple[Option, ...]
    can_continue: bool


def resting(gates: Iterable[Gate | Interruption], outside: Container[str]) -> Resting:
    """The state of processes that halt; ``outside`` are the channels of the environment."""
    options = [(gate.task, option) for gate in gates for option in gate.options]
    offers = tuple(option for _, option in options if option.channel in outside)
    written = [(task, option.channel) for task, option in options if option.action == "write"]
    can_continue = any(option.action in _BY_ITSELF for _, option in options) or any(
        channel == option.channel and task is not writer and channel not in outside
        for writer, channel in written
        for task, option in options
        if option.action in ("read", "ready")
    )
    return Resting(offers, can_continue)
