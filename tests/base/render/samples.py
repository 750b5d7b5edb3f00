"""Handmade diagnostics, for tests of how they are shown."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Label, Severity, SourceFile, Span
from cspdiag.base.record import record


@record
class Sample(Diagnostic):
    """Two ends of an arrow differ; the code is a real one, because whatever has a code has a manual page."""

    code: ClassVar[str] = "E0316"
    title: ClassVar[str] = "ends differ"

    text: str
    beside: str = ""
    fix: str | None = None
    places: tuple[Label, ...] = ()

    @property
    def message(self) -> str:
        return self.text

    @property
    def label(self) -> str:
        return self.beside

    @property
    def help(self) -> str | None:
        return self.fix

    @property
    def labels(self) -> tuple[Label, ...]:
        return self.places


@record
class SampleWarning(Sample):
    """Something looks odd."""

    code: ClassVar[str] = "W0512"
    title: ClassVar[str] = "odd"
    severity: ClassVar[Severity] = "warning"


def source(text: str, name: str = "arm.csp") -> SourceFile:
    return SourceFile(name=name, text=text)


def at(file: SourceFile, words: str) -> Span:
    """Where ``words`` first occur in a file."""
    start = file.text.index(words)
    return Span(file, start, start + len(words))
