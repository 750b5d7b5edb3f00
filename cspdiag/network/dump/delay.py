"""Delays and time-outs in words, and what such words say."""

from __future__ import annotations

from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import AfterEvent, WaitStep


def delay_text(delay: WaitStep | AfterEvent) -> str:
    """``wait 5 ms``, or ``after 5 ms`` of a guard."""
    return f"{'wait' if isinstance(delay, WaitStep) else 'after'} {expression_text(delay.duration)}"


def is_of_time_out(words: str) -> bool:
    """Whether words of an event, with the process in front or not, are those of a guard: ``Top.law: after 5 ms``."""
    return words.rpartition(": ")[2].startswith("after ")
