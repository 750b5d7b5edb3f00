"""Recovery from syntax errors: where reading continues."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.syntax.parse.automaton import Automaton
from cspdiag.syntax.parse.lexer import Lexer
from cspdiag.syntax.parse.tables import END

_DEFINITIONS = frozenset(
    [
        *("IMPORT", "CONST", "TYPE", "ENUM", "STRUCT", "EXCEPTION"),
        *("PROCESS", "SUBMODEL", "DRIVER", "ENVIRONMENT", "ASSERT"),
    ]
)
"""The keywords that begin a definition."""

_PARTS = frozenset(
    ["IN", "OUT", "COMMUNICATION", "COMPOSITION", "VAR", "CHANNEL", "FOR", "LET", "STATE", "NEXT", "DER"]
)
"""The keywords that begin a part of a definition."""

_AFTER_FIRST_NAME = frozenset([":", "=", "-", ",", ".", "["])
"""The characters that can follow the name that begins a declaration or an equation."""


def skip(automaton: Automaton, states: list[int], lexer: Lexer) -> int:
    """Advances to a token at which reading can continue, and returns the number of states to keep. This token begins a
    definition, or a declaration or equation on a line of its own, or it is the end of the block or of the text.
    """
    depth = 0
    while lexer.kind != END:
        if begins_definition(lexer):
            return _complete_states(automaton, states)
        if lexer.kind == "LBRACE":
            depth += 1
        elif lexer.kind == "RBRACE" and depth > 0:
            depth -= 1
        elif lexer.kind == "RBRACE":
            height = _after_block(automaton, states, lexer)
            if height is not None:
                return height
        elif depth == 0 and _begins_declaration(lexer):
            height = _restart(automaton, states, lexer.kind)
            if height is not None:
                return height
        lexer.advance({})
    return _complete_states(automaton, states)


def begins_definition(lexer: Lexer) -> bool:
    """Whether the present token begins a definition: a keyword at the beginning of a line, followed by a name."""
    if lexer.kind not in _DEFINITIONS or not lexer.first_on_line():
        return False
    following = lexer.next_character()
    return following.isalpha() or following == "_" or (lexer.kind == "IMPORT" and following == '"')


def begins_part(lexer: Lexer) -> bool:
    """Whether the present token begins a port, a block, a declaration or an equation: a keyword at the beginning of a
    line, followed by what is required after it.
    """
    if lexer.kind not in _PARTS or not lexer.first_on_line():
        return False
    following = lexer.next_character()
    return following.isalpha() or following in {"_", "{"}


def _complete_states(automaton: Automaton, states: list[int]) -> int:
    """The number of states that belong to complete definitions."""
    return 2 if len(states) > 1 and automaton.restartable(states[1]) else 1


def _begins_declaration(lexer: Lexer) -> bool:
    if begins_part(lexer):
        return True
    return lexer.kind == "NAME" and lexer.first_on_line() and lexer.next_character() in _AFTER_FIRST_NAME


def _open(automaton: Automaton, states: list[int]) -> Iterator[tuple[int, int, str]]:
    """The heights of the stack, innermost first, with their states and symbols; closed blocks are omitted."""
    closed = 0
    for height in range(len(states), 0, -1):
        symbol = automaton.tables.symbols[states[height - 1]]
        if not closed:
            yield height, states[height - 1], symbol
        if symbol == "RBRACE":
            closed += 1
        elif symbol == "LBRACE" and closed:
            closed -= 1


def _restart(automaton: Automaton, states: list[int], terminal: str) -> int | None:
    """The number of states to keep so that ``terminal`` can begin something; None if it cannot."""
    for height, state, symbol in _open(automaton, states):
        if symbol == "COMPOSITION" or symbol == "ENUM":
            # Inside of these a name does not begin a declaration; a keyword does, in the block around them.
            if terminal == "NAME":
                return None
        elif automaton.restartable(state) and automaton.accepts(states[:height], terminal):
            return height
        elif terminal == "NAME" and automaton.restartable(state):
            return None
        if symbol == "LBRACE" and terminal not in {"COMMUNICATION", "COMPOSITION"}:
            return None
    return None


def _after_block(automaton: Automaton, states: list[int], lexer: Lexer) -> int | None:
    """The number of states to keep if the innermost block ends here; a block that is not a list is discarded."""
    for height, state, symbol in _open(automaton, states):
        if symbol in {"COMPOSITION", "ENUM"}:
            lexer.advance({})
            return height - 1
        if automaton.restartable(state) and automaton.accepts(states[:height], "RBRACE"):
            return height
    return None
