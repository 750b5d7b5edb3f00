"""Writes delays and time-outs in words, and recognizes such words."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import AfterEvent, WaitStep
from cspdiag.network.ir.expressions import FunctionCall


def delay_text(delay: WaitStep | AfterEvent) -> str:
    """The text of a delay, ``wait 5 ms``, or of a guard, ``after 5 ms`` or ``at 5 ms``."""
    match delay:
        case AfterEvent(duration=FunctionCall(function="until", arguments=(instant, _))):
            return f"at {expression_text(instant)}"
        case AfterEvent():
            return f"after {expression_text(delay.duration)}"
        case WaitStep():
            return f"wait {expression_text(delay.duration)}"
        case _:
            assert_never(delay)


def until_instant(words: str) -> str:
    """The part of such words for a delay until an instant: ``at t + 5 ms``; empty for other delays."""
    delay = words.rpartition(": ")[2]
    return delay if delay.startswith(("at ", "wait until ")) else ""


def is_of_time_out(words: str) -> bool:
    """Whether the words of an event, with or without the name of the process before them, are those of a guard:
    ``Top.law: after 5 ms``.
    """
    return words.rpartition(": ")[2].startswith(("after ", "at "))
