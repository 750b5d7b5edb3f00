"""Findings that something never happens at a place in the text.

A place represents as many parts of a program as there are iterations of replicators and instances. What is never
chosen, reached or used in one of them may be in another, and the advice to remove it would break that one. So a finding
holds only if all of them agree.
"""

from __future__ import annotations

from cspdiag.base import Diagnostic, Report, Span


class Agreement:
    """Collects the findings at each place, and what refutes them."""

    def __init__(self) -> None:
        self._claimed: dict[tuple[type[Diagnostic], Span, str], Diagnostic] = {}
        self._refuted: set[tuple[type[Diagnostic], Span, str]] = set()

    def claim(self, diagnostic: Diagnostic, name: str = "") -> None:
        """Add a finding at its place; ``name`` distinguishes several things that are declared at one place."""
        self._claimed.setdefault((type(diagnostic), diagnostic.span, name), diagnostic)

    def refute(self, kind: type[Diagnostic], span: Span, name: str = "") -> None:
        """Note an iteration or an instance in which such a finding is not true."""
        self._refuted.add((kind, span, name))

    def report(self, report: Report) -> None:
        """Report the findings that nothing refutes, each for the first iteration or instance."""
        for key, diagnostic in self._claimed.items():
            if key not in self._refuted:
                report.add(diagnostic)
