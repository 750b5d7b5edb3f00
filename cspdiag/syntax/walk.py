"""Traversals of the tree, without recursion on operator chains."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import assert_never

from cspdiag.base.record import field_names, is_record
from cspdiag.syntax import ast

_SKIPPED = frozenset(
    {"source", "comments", "span", "unit_span", "target_span", "composition_span", "inner_span", "doc"}
)
_INSIDE: dict[type, tuple[str, ...] | None] = {}
"""The fields of each kind of node that may hold nodes, the last one first; None for other values."""


def _names_inside(item: object) -> tuple[str, ...] | None:
    if not isinstance(item, ast.Node):
        assert not is_record(item), item
        return None
    return tuple(name for name in reversed(field_names(item)) if name not in _SKIPPED)


def nodes(*roots: ast.Node | None) -> Iterator[ast.Node]:
    """Every node below the roots, parents first, in text order."""
    pending: list[object] = [root for root in reversed(roots) if root is not None]
    while pending:
        item = pending.pop()
        try:
            names = _INSIDE[type(item)]
        except KeyError:
            names = _INSIDE[type(item)] = _names_inside(item)
        if names is not None:
            yield item  # type: ignore[misc]
            for name in names:
                inner = getattr(item, name)
                if inner is not None:
                    pending.append(inner)
        elif isinstance(item, tuple):
            pending.extend(reversed(item))


def names(expressions: Iterable[ast.Node | None]) -> Iterator[ast.Name]:
    """Every name used as a value in the expressions."""
    for item in nodes(*expressions):
        if isinstance(item, ast.Name):
            yield item


def declarations(block: Iterable[ast.Declaration]) -> Iterator[ast.Declaration]:
    """Every declaration of a block, also inside ``for``."""
    pending = list(reversed(list(block)))
    while pending:
        item = pending.pop()
        yield item
        if isinstance(item, ast.RepeatedDeclarations):
            pending.extend(reversed(item.declarations))


def declared_in(definition: ast.ProcessDefinition) -> Iterator[ast.Declaration]:
    """Every declaration of a process."""
    if definition.communication is not None:
        yield from declarations(definition.communication.declarations)


def instances_in(definition: ast.Definition) -> Iterator[ast.Instance]:
    """Every instance that a definition declares, also inside ``for``, in text order."""
    items: Iterable[ast.Node]
    match definition:
        case ast.ProcessDefinition():
            items = declared_in(definition)
        case ast.SubmodelDefinition(items=items):
            pass
        case ast.EnvironmentDefinition():
            items = declarations(definition.declarations)
        case (
            ast.Constant() | ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition()
            | ast.ExceptionDefinition() | ast.DriverDefinition()
        ):  # fmt: skip
            items = ()
        case _:
            assert_never(definition)
    return (item for item in items if isinstance(item, ast.Instance))
