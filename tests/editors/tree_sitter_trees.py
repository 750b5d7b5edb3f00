"""Trees of the tree-sitter grammar and of the compiler's grammar, in one form in which they can be compared."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import tree_sitter

from cspdiag.base import Report, SourceFile
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.parse.lexer import Token
from cspdiag.syntax.parser import Parser

FOLDER = Path(__file__).parents[2] / "editors" / "tree-sitter-csp"


class Tree(NamedTuple):
    """A node with its range in the text, as offsets of characters."""

    rule: str
    start: int
    end: int
    children: tuple[Tree, ...]


def compiled(folder: Path) -> tree_sitter.Language:
    """The language, compiled from its sources as editors do."""
    library = folder / "csp.so"
    sources = [str(FOLDER / "src" / name) for name in ("parser.c", "scanner.c")]
    warnings = ["-Wall", "-Wextra", "-Werror"]
    subprocess.run(
        ["cc", "-O1", "-shared", "-fPIC", *warnings, f"-I{FOLDER / 'src'}", *sources, "-o", str(library)], check=True
    )
    make = ctypes.CDLL(str(library)).tree_sitter_csp
    make.restype = ctypes.c_void_p
    capsule = ctypes.pythonapi.PyCapsule_New
    capsule.restype = ctypes.py_object
    capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return tree_sitter.Language(capsule(make(), b"tree_sitter.Language", None))


_TOKENS = frozenset({"comment", "doc_comment", "string", "unit"})
"""Nodes that are tokens without a rule in the compiler's grammar."""
_LEAVES = frozenset({"quantity", "duration", "number"})


def tree_of(node: tree_sitter.Node, text: str) -> Tree:
    """A tree of tree-sitter."""
    encoded = text.encode()
    same = len(encoded) == len(text)

    def converted(node: tree_sitter.Node) -> Tree:
        inner = (
            () if node.type in _LEAVES else tuple(converted(c) for c in node.named_children if c.type not in _TOKENS)
        )
        start, end = node.start_byte, node.end_byte
        if not same:
            start, end = len(encoded[:start].decode()), len(encoded[:end].decode())
        return Tree(node.type, start, end, inner)

    return converted(node)


_RENAMED = {
    "start": "source_file",
    "connection_direct": "connection",
    "connection_through": "connection",
    "connection_to_label": "connection",
    "medium_kind": "medium",
    "medium_typed": "medium",
    "medium_type": "medium",
    "if_then": "if_step",
    "if_else": "if_step",
    "named": "named_argument",
}
_WITHOUT_NODE = frozenset(
    [
        *("options", "environment_options", "port_list", "declarations", "equations", "references"),
        *("untimed", "sampled", "sampled_immediate", "name", "positional", "text"),
        # Terminals that the compiler's grammar keeps.
        *("direction", "plain_kind", "fifo_kind", "replicated_operator"),
        *("comparison_operator", "adding", "multiplying"),
    ]
)
"""Rules whose children belong to the node around them."""


class _Trees(tuple[Tree, ...]):
    """The value of a rule; the parser counts the levels of parentheses by the attribute."""

    parenthesized = False


class _Builder:
    """In place of the builder of the compiler's tree: a method for each rule, which makes the node of that rule."""

    def __getattr__(self, rule: str) -> Any:
        name = _RENAMED.get(rule, rule)

        def build(span: Span, *parts: object) -> _Trees:
            children = _Trees(_children(parts))
            if rule in _WITHOUT_NODE or (rule == "hidden" and not children):
                return children
            return _Trees([Tree(name, span.start, span.end, tuple(children))])

        return build


def _children(parts: tuple[object, ...] | list[object]) -> Iterator[Tree]:
    for part in parts:
        match part:
            case Tree():
                yield part
            case tuple() | list() if not isinstance(part, Token):
                yield from _children(part)  # type: ignore[arg-type]
            case ast.Identifier(span=span):
                yield Tree("identifier", span.start, span.end, ())
            case Token() | None:
                pass
            case _:
                raise AssertionError(part)


class _TreeParser(Parser):
    def __init__(self, source: SourceFile, report: Report) -> None:
        super().__init__(source, report)
        builder = _Builder()
        self._builders = [getattr(builder, rule.build) if rule.build else None for rule in self.automaton.tables.rules]

    def _tree(self, items: Any) -> Any:
        return items


def compilers_tree(text: str) -> Tree | None:
    """The tree of the compiler's grammar; None for a text with errors of syntax."""
    report = Report()
    (tree,) = _TreeParser(SourceFile(name="case.csp", text=text), report).run()  # type: ignore[misc]
    return None if report.diagnostics else tree  # type: ignore[return-value]


def first_difference(left: Tree, right: Tree) -> str:
    """A sentence that says where two trees differ first; empty if they are equal."""
    pending = [(left, right)]
    while pending:
        one, other = pending.pop()
        if one[:3] != other[:3]:
            return f"{one[:3]} and {other[:3]}"
        if len(one.children) != len(other.children):
            inside = [[child[:3] for child in tree.children] for tree in (one, other)]
            return f"inside {one[:3]}: {inside[0]} and {inside[1]}"
        pending += zip(one.children, other.children, strict=True)
    return ""
