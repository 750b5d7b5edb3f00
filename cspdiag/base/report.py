"""The report into which passes add diagnostics, so one run shows everything that is wrong."""

from __future__ import annotations

from cspdiag.base.diagnostic import Diagnostic, Label


class Report:
    """Diagnostics of one run, each reported once.

    The same kind of diagnostic at the same place is kept once, whatever the number of instances that lead to it.
    """

    def __init__(self) -> None:
        self._found: dict[tuple[str, str, int, int], Diagnostic] = {}
        self.suspects: tuple[Label, ...] = ()
        """Settings from outside in a program that has no errors without them; every error shows them from now on."""

    def add(self, diagnostic: Diagnostic) -> None:
        """Add a diagnostic, unless the same code was already reported for the same range of characters."""
        span = diagnostic.span
        if self.suspects and diagnostic.severity == "error":
            diagnostic = diagnostic.with_labels(self.suspects)
        self._found.setdefault((diagnostic.code, span.file, span.start, span.end), diagnostic)

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """All diagnostics by file and place."""
        return sorted(self._found.values(), key=lambda d: (d.span.file, d.span.start, d.code))

    @property
    def first_error(self) -> Diagnostic | None:
        """The first error by file and place."""
        return next((found for found in self.diagnostics if found.severity == "error"), None)

    @property
    def has_errors(self) -> bool:
        """Whether any diagnostic is an error."""
        return any(d.severity == "error" for d in self._found.values())
