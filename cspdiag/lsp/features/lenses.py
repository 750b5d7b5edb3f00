"""Code lenses: an assertion is proved where it is written."""

from __future__ import annotations

from lsprotocol import types

from cspdiag.lsp.positions import Positions
from cspdiag.lsp.view import View
from cspdiag.syntax import ast

VERIFY = "cspdiag.verify"
"""The command that proves the assertions of a file: its arguments are the URI and the line of an assertion, from 0."""


def lenses(view: View, uri: str, positions: Positions) -> list[types.CodeLens]:
    """A lens for each assertion; after a proof its title is the answer."""
    found = []
    for item in assertions(view):
        place = positions.range(item.span)
        answer = view.answers.get(item.span.start)
        title = "Verify" if answer is None else answer.title
        found.append(types.CodeLens(place, types.Command(title, VERIFY, arguments=[uri, place.start.line])))
    return found


def assertions(view: View) -> list[ast.Assertion]:
    """The assertions of the main file."""
    return [item for item in view.tree.items if isinstance(item, ast.Assertion)]


def assertion_at(view: View, line: int) -> ast.Assertion | None:
    """The assertion that begins on a line, counted from 0."""
    return next((item for item in assertions(view) if item.span.line == line + 1), None)
