"""What the builders of the tree have in common."""

from __future__ import annotations

from cspdiag.base import Report, SourceFile
from cspdiag.syntax import ast


class Construction:
    """Builds the nodes of one file; the methods are named as the rules of the grammar (or their aliases)."""

    def __init__(self, source: SourceFile, report: Report, docs: dict[int, list[ast.Comment]]) -> None:
        self.source = source
        self.report = report
        self._docs = docs

    def doc(self, start: int) -> str | None:
        """The doc comment of what begins at an offset: its lines without their marks."""
        comments = self._docs.pop(start, None)
        if comments is None:
            return None
        return "\n".join(comment.text[3:].removeprefix(" ") for comment in comments)
