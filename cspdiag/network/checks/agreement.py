"""Findings that say "never" of a place in the text: they hold only if all iterations of a replicator and all instances
agree. A place represents as many parts of a program as there are iterations and instances. What is never chosen,
reached or used in one of them may well be in another, and the advice to remove it would break that one.
"""

from __future__ import annotations

from cspdiag.base import Diagnostic, Report, Span


class Agreement:
    """Collects what is found at each place, and what contradicts it."""

    def __init__(self) -> None:
        self._found: dict[tuple[type[Diagnostic], Span, str], Diagnostic] = {}
        self._refuted: set[tuple[type[Diagnostic], Span, str]] = set()

    def found(self, diagnostic: Diagnostic, name: str = "") -> None:
        """A finding at its place; ``name`` distinguishes several things that are declared at one place."""
        self._found.setdefault((type(diagnostic), diagnostic.span, name), diagnostic)

    def refuted(self, kind: type[Diagnostic], span: Span, name: str = "") -> None:
        """An iteration or an instance for which such a finding is not true."""
        self._refuted.add((kind, span, name))

    def report(self, report: Report) -> None:
        """Report, for the first iteration or instance, what nothing contradicts."""
        for key, diagnostic in self._found.items():
            if key not in self._refuted:
                report.add(diagnostic)
