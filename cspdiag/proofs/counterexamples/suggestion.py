"""A change of the text that removes a deadlock."""

from __future__ import annotations

from difflib import unified_diff
from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.record import record, replaced


@record
class Suggestion:
    """A change: ``words`` say what to do, ``replacement`` is the new text of ``span``.

    ``proved_with`` is a setting of a constant, such as ``seats=2``, if the property was proved for a smaller program
    only.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    words: str
    span: Span
    replacement: str
    proved_with: str | None = None

    @property
    def text(self) -> str:
        """The whole file after the change."""
        whole = self.span.source.text
        return whole[: self.span.start] + self.replacement + whole[self.span.end :]

    @property
    def difference(self) -> tuple[str, ...]:
        """The removed lines, beginning with ``-``, and the added ones, with ``+``, in the order of the file."""
        before, after = (text.splitlines() for text in (self.span.source.text, self.text))
        return tuple(line.rstrip() for line in unified_diff(before, after, n=0, lineterm="") if _is_changed_line(line))

    def in_text(self, text: str) -> Suggestion:
        """The change that replaces whole lines so that the file becomes ``text``."""
        before, after = (whole.splitlines(keepends=True) for whole in (self.span.source.text, text))
        first = _common(before, after)
        last = _common(before[first:][::-1], after[first:][::-1])
        span = Span(self.span.source, sum(map(len, before[:first])), sum(map(len, before[: len(before) - last])))
        return replaced(self, span=span, replacement="".join(after[first : len(after) - last]))


def _is_changed_line(line: str) -> bool:
    return line[0] in "+-" and not line.startswith(("--- ", "+++ "))


def _common(one: list[str], other: list[str]) -> int:
    return next(
        (number for number, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other))
    )
