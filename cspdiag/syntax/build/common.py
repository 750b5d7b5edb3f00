"""The common part of the builders of the tree."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cspdiag.base import Report, SourceFile
from cspdiag.base.span import Span
from cspdiag.syntax import ast


class Construction:
    """Builds the nodes of one file; the methods have the names of the rules of the grammar, or of their aliases."""

    def __init__(self, source: SourceFile, report: Report, docs: dict[int, list[ast.Comment]]) -> None:
        self.source = source
        self.report = report
        self._docs = docs

    def doc(self, start: int) -> str | None:
        """The doc comment of the node that begins at an offset: its lines without the comment markers."""
        comments = self._docs.pop(start, None)
        if comments is None:
            return None
        return "\n".join(comment.text[3:].removeprefix(" ") for comment in comments)


Built = Callable[..., Any]
"""A method of a builder, whose arguments are the place of a rule and its children."""


def node(kind: Callable[..., ast.Node], *fields: str, **fixed: object) -> Built:
    """A method that builds a node whose ``fields`` are the children of the rule, in order; ``fixed`` fields always have
    the same value.
    """

    def build(_: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, **dict(zip(fields, children, strict=True)), **fixed)

    return build


def declared(kind: Callable[..., ast.Node], *fields: str, **fixed: object) -> Built:
    """The same for a node that may have a doc comment."""

    def build(builder: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, doc=builder.doc(span.start), **dict(zip(fields, children, strict=True)), **fixed)

    return build


def chain(kind: Callable[..., ast.Node], field: str, **fixed: object) -> Built:
    """A method that builds a node with all children in one field."""

    def build(_: Construction, span: Span, *children: object) -> ast.Node:
        return kind(span=span, **{field: children}, **fixed)

    return build


def as_tuple(_: Construction, __: Span, *children: object) -> tuple[object, ...]:
    """The children of a list rule, as a tuple."""
    return children
