"""Delays and time-outs in words, and what such words say."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import AfterEvent, WaitStep
from cspdiag.network.ir.expressions import FunctionCall


def delay_text(delay: WaitStep | AfterEvent) -> str:
    """``wait 5 ms``, or of a guard ``after 5 ms`` and ``at 5 ms``."""
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
    """The part of such words that is of the delay, where it lasts until an instant: ``at t + 5 ms``; or nothing."""
    delay = words.rpartition(": ")[2]
    return delay if delay.startswith(("at ", "wait until ")) else ""


def is_of_time_out(words: str) -> bool:
    """Whether words of an event, with the process in front or not, are those of a guard: ``Top.law: after 5 ms``."""
    return words.rpartition(": ")[2].startswith(("after ", "at "))
