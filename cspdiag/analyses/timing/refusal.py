"""Why the timing analysis has no bound."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.record import record


@record
class Refusal:
    """What has no bound, why, where, and how to change that."""

    uncompared: ClassVar[frozenset[str]] = frozenset()

    subject: str
    reason: str
    span: Span
    help: str
