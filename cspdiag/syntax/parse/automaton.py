"""The automaton of the language: the parse tables, and tables that are computed from them once."""

from __future__ import annotations

from functools import lru_cache

from cspdiag.syntax.parse import tables
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS, Scanner

_REPEATABLE = frozenset(
    ["item", "ports", "declaration", "equation", "field", "communication_block", "composition_block"]
)
"""Where reading can continue after an error."""

_NESTING = frozenset(
    [
        *("binary", "unary", "conditional", "member", "indexed", "call", "array", "repeated_declarations"),
        *("sequence", "parallel", "prioritized_parallel", "alternative", "prioritized_alternative", "replicated"),
        *("mu", "while_do", "if_then", "if_else", "labelled", "guarded", "catch", "interrupt"),
    ]
)
"""The rules whose nodes are a level of the tree."""


class Automaton:
    """The parse tables and the scanner; immutable."""

    def __init__(self, loaded: tables.Tables) -> None:
        self.tables = loaded
        self.scanner = Scanner(loaded)
        self.valued = frozenset(loaded.valued)
        self.levels = [1 if rule.build in _NESTING else 0 for rule in loaded.rules]
        self.contextual_keywords = frozenset(loaded.words[word] for word in CONTEXTUAL_KEYWORDS)
        self.terminal_texts = {terminal: text for text, terminal in loaded.words.items()}

    def restartable(self, state: int) -> bool:
        """Whether a declaration or definition can begin in a state."""
        return not _REPEATABLE.isdisjoint(self.tables.gotos[state])

    def accepts(self, states: list[int], terminal: str) -> bool:
        """Whether the parser with these states accepts a terminal, after the reductions that precede it."""
        top = self._reduced(states, terminal)
        return terminal in self.tables.actions[top] or (terminal == tables.END and self.tables.symbols[top] == "start")

    def shifting(self, states: list[int], terminal: str) -> int | None:
        """The state in which the parser with these states takes a terminal; None if it does not accept it."""
        top = self._reduced(states, terminal)
        return top if terminal in self.tables.actions[top] else None

    def _reduced(self, states: list[int], terminal: str) -> int:
        """The state after the reductions that precede a terminal, accepted or not."""
        actions, gotos, rules = self.tables.actions, self.tables.gotos, self.tables.rules
        # The states below `base` are not changed; `top` has the states that the reductions push above it.
        base, top = len(states), [states[-1]]
        base -= 1
        while True:
            action = actions[top[-1]].get(terminal)
            if action is None or action >= 0:
                return top[-1]
            rule = rules[~action]
            surplus = rule.length - len(top)
            if surplus < 0:
                del top[len(top) - rule.length :]
            else:
                base -= surplus + 1
                top = [states[base]]
            top.append(gotos[top[-1]][rule.origin])


@lru_cache(maxsize=1)
def automaton() -> Automaton:
    """The automaton of the language."""
    return Automaton(tables.load())
