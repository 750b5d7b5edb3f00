"""Code lenses: an assertion is proved where it is written."""

from __future__ import annotations

from collections.abc import Mapping

from lsprotocol import types

from cspdiag.base.record import EMPTY
from cspdiag.editing.view import View
from cspdiag.lsp.positions import Positions
from cspdiag.syntax import ast

VERIFY = "cspdiag.verify"
"""The command that proves the assertions of a file: its arguments are the URI and the line of an assertion, from 0."""


RUN, PLOT, STEP = "cspdiag.run", "cspdiag.plot", "cspdiag.step"
"""Commands of editors, which say in their experimental capabilities that they have them: to run an environment, given
by the URI, its name, its line from 0 and the fingerprint of the program, and to show the steps of a counterexample,
given by the URI and the steps.
"""


def lenses(
    view: View,
    uri: str,
    positions: Positions,
    commands: frozenset[str] = frozenset(),
    answered: Mapping[str, str] = EMPTY,
) -> list[types.CodeLens]:
    """A lens for each assertion, whose title is the answer after a proof, or what was ``answered`` before the program
    changed; others for the ``commands`` that the editor has.
    """
    found = []
    for item in assertions(view):
        place = positions.range(item.span)
        answer = view.answers.get(item.span.start)
        title = _title(answered.get(asserted(item))) if answer is None else answer.title
        found.append(types.CodeLens(place, types.Command(title, VERIFY, arguments=[uri, place.start.line])))
        if answer is not None and answer.steps and STEP in commands:
            step = types.Command("Step through", STEP, arguments=[uri, list(answer.steps)])
            found.append(types.CodeLens(place, step))
    for environment in view.tree.items:
        if isinstance(environment, ast.EnvironmentDefinition):
            place = positions.range(environment.name.span)
            arguments = [uri, environment.name.text, place.start.line, view.fingerprint]
            for title, command in (("Run", RUN), ("Plot", PLOT)):
                if command in commands:
                    found.append(types.CodeLens(place, types.Command(title, command, arguments=list(arguments))))
    return found


def _title(before: str | None) -> str:
    if before is None:
        return "Verify"
    outcome, _, reason = before.partition(": ")
    return f"Verify again ({outcome.lower()} before the change: {reason})"


def asserted(assertion: ast.Assertion) -> str:
    """The text of an assertion in one line."""
    return " ".join(assertion.span.text.split())


def commands_of(capabilities: types.ClientCapabilities) -> frozenset[str]:
    """The commands that an editor says it has."""
    experimental = capabilities.experimental
    named = experimental.get("cspdiag") if isinstance(experimental, dict) else getattr(experimental, "cspdiag", None)
    commands = named.get("commands") if isinstance(named, dict) else getattr(named, "commands", None)
    return frozenset(commands) if isinstance(commands, list) else frozenset()


def assertions(view: View) -> list[ast.Assertion]:
    """The assertions of the main file."""
    return [item for item in view.tree.items if isinstance(item, ast.Assertion)]


def assertion_at(view: View, line: int) -> ast.Assertion | None:
    """The assertion that begins on a line, counted from 0."""
    return next((item for item in assertions(view) if item.span.line == line + 1), None)
