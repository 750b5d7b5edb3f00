"""What the builders of the tree have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cspdiag.base import Report, SourceFile
from cspdiag.base.span import Span
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


Built = Callable[..., Any]
"""A method of a builder, which gets the place of a rule and its children."""


def node(kind: Callable[..., ast.Node], *fields: str, **fixed: object) -> Built:
    """Builds a node whose ``fields`` are the children of the rule, in their order; the ``fixed`` ones are the same
    wherever the rule stands.
    """

    def build(_: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, **dict(zip(fields, children, strict=True)), **fixed)

    return build


def declared(kind: Callable[..., ast.Node], *fields: str) -> Built:
    """The same of what may have a doc comment."""

    def build(builder: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, doc=builder.doc(span.start), **dict(zip(fields, children, strict=True)))

    return build


def chain(kind: Callable[..., ast.Node], field: str, **fixed: object) -> Built:
    """Builds a node with all children in one field."""

    def build(_: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, **{field: children}, **fixed)

    return build


def gathered(_: Construction, __: Span, *children: object) -> tuple[object, ...]:
    """What a list of the grammar becomes."""
    return children
