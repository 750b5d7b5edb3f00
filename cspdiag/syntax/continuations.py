"""What can follow the beginning of a text: for completion, where a text ends in the middle of a word or a rule."""

from __future__ import annotations

from cspdiag.base import Report, SourceFile
from cspdiag.base.record import record
from cspdiag.syntax.parse.tables import END
from cspdiag.syntax.parser import Parser


@record
class Continuations:
    """``keywords`` are the words that can follow; ``rules`` the rules of the grammar that a name can begin, empty where
    no name or a new name is expected. ``accepts_name``: whether a name can follow at all.
    """

    keywords: tuple[str, ...]
    rules: frozenset[str]
    accepts_name: bool


def continuations(beginning: SourceFile) -> Continuations:
    """What can follow a beginning, whose mistakes are passed over as the parser does."""
    parser = _Beginning(beginning, Report())
    parser.run_to_end()
    automaton, states = parser.automaton, parser.states
    words = sorted(word for word in automaton.tables.words if word[0].isalpha())
    keywords = tuple(word for word in words if automaton.accepts(states, automaton.tables.words[word]))
    state = automaton.shifting(states, "NAME")
    rules = frozenset(automaton.tables.gotos[state]) if state is not None else frozenset[str]()
    return Continuations(keywords, rules, state is not None)


class _Beginning(Parser):
    """Reads a beginning without what the parser does only at the end of a text."""

    def run_to_end(self) -> None:
        """Read up to the end, where ``states`` are those of the parser."""
        actions = self.automaton.tables.actions
        self.lexer.advance(actions[self.states[-1]])
        while self.lexer.kind != END:
            action = actions[self.states[-1]].get(self.lexer.kind)
            if action is None:
                self._repair()
            elif action >= 0:
                self._shift(action)
            else:
                self._reduce(~action)
