"""Diagnostics for people at a terminal: the source with the places marked, the reason, the correction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.render.snippet import Mark, Role, draw, on_one_line, printable
from cspdiag.base.span import SourceFile

_COLOURS = {"error": "31", "warning": "33", "secondary": "34", "frame": "34", "strong": "1", "help": "36"}


def render(diagnostics: Sequence[Diagnostic], *, colour: bool = False) -> str:
    """All diagnostics, each with its source, and a line that counts them; empty without diagnostics."""
    if not diagnostics:
        return ""
    parts = [_Drawing(diagnostic, colour).text() for diagnostic in diagnostics]
    return "\n".join([*parts, f"{summary(diagnostics)}\n"])


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """``3 errors, 1 warning``, or ``no errors``."""
    severities = [diagnostic.severity for diagnostic in diagnostics]
    counts = [
        f"{count} {severity}{'' if count == 1 else 's'}"
        for severity in ("error", "warning")
        if (count := severities.count(severity))
    ]
    return ", ".join(counts) or "no errors"


class _Drawing:
    """One diagnostic on its way to text."""

    def __init__(self, diagnostic: Diagnostic, colour: bool) -> None:
        self._diagnostic = diagnostic
        self._words = diagnostic.words
        self._colour = colour
        self._marks: dict[SourceFile, list[Mark]] = {}
        self._mark(Mark(diagnostic.span, on_one_line(self._words.label), True))
        for label in self._words.labels:
            self._mark(Mark(label.span, on_one_line(label.message), False))
        highest = max(mark.lines[1] for marks in self._marks.values() for mark in marks)
        self._gutter = len(str(highest))

    def _mark(self, mark: Mark) -> None:
        self._marks.setdefault(mark.span.source, []).append(mark)

    def text(self) -> str:
        """The diagnostic with its head, a snippet for each file it points into, and its help."""
        diagnostic = self._diagnostic
        head = self._style(f"{diagnostic.severity}[{diagnostic.code}]", diagnostic.severity, strong=True)
        lines = [f"{head}{self._style(f': {on_one_line(self._words.message)}', strong=True)}"]
        arrow = "-->"
        for source, marks in self._marks.items():
            if arrow == ":::":
                lines.append(self._bar())
            first = marks[0].span
            place = f"{on_one_line(source.name)}:{first.line}:{first.column}"
            lines.append(f"{' ' * self._gutter}{self._style(arrow, 'frame')} {place}")
            lines.append(self._bar())
            lines += draw(source, marks, self._gutter, self._paint)
            arrow = ":::"
        if self._words.help:
            lines.append(self._bar())
            lines += self._help(self._words.help)
        return "\n".join(lines) + "\n"

    def _help(self, text: str) -> list[str]:
        first, *rest = printable(text).split("\n")
        equals = self._style("=", "frame")
        word = self._style("help", "help", strong=True)
        indent = " " * (self._gutter + len(" = help: "))
        return [f"{' ' * self._gutter} {equals} {word}: {first}", *(f"{indent}{line}".rstrip() for line in rest)]

    def _bar(self) -> str:
        return " " * self._gutter + self._style(" |", "frame")

    def _paint(self, text: str, role: Role) -> str:
        if role == "plain":
            return text
        kind = self._diagnostic.severity if role == "primary" else role
        return self._style(text, kind, strong=True)

    def _style(
        self,
        text: str,
        kind: Literal["error", "warning", "secondary", "frame", "help"] | None = None,
        *,
        strong: bool = False,
    ) -> str:
        if not self._colour or not text.strip():
            return text
        codes = [_COLOURS["strong"]] * strong + ([_COLOURS[kind]] if kind else [])
        return f"\x1b[{';'.join(codes)}m{text}\x1b[0m"
