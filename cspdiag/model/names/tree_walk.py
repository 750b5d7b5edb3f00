"""The nodes of a tree, one after another."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import field_names, is_record
from cspdiag.syntax import ast


def walk(root: ast.Node) -> Iterator[ast.Node]:
    """A node and all nodes below it, in text order."""
    pending: list[object] = [root]
    while pending:
        item = pending.pop()
        if isinstance(item, tuple):
            pending += reversed(item)
        elif isinstance(item, ast.Node) and is_record(item):
            yield item
            pending += [getattr(item, name) for name in reversed(field_names(item)) if name != "source"]
