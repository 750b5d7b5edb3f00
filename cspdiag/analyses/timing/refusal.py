"""What the timing analysis has no bound for."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.record import record


@record
class Refusal:
    """Something that has no bound, why, where, and what helps."""

    uncompared: ClassVar[frozenset[str]] = frozenset()

    subject: str
    reason: str
    span: Span
    help: str
