"""What was proved of an assertion while its text was open."""

from __future__ import annotations

from typing import Any

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.record import record


@record
class Proved:
    """The answer about one assertion, which begins at ``start``; ``found`` says how it fails, if it does."""

    start: int
    title: str
    found: Diagnostic | None
    steps: tuple[dict[str, Any], ...] = ()
    """How it comes to that, for diagrams."""
