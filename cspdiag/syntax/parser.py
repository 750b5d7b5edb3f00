"""Text to syntax tree: an LALR(1) automaton over the tables that Lark made of the grammar."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

from cspdiag.diagnostics import Report, SourceFile
from cspdiag.diagnostics.span import Span
from cspdiag.syntax import ast, tables
from cspdiag.syntax.build_definitions import DefinitionBuilder
from cspdiag.syntax.diagnostics import UnexpectedText
from cspdiag.syntax.lexer import Lexer, Scanner, Token
from cspdiag.syntax.tables import Tables


class Automaton(NamedTuple):
    """The tables and what is made of them once per run."""

    tables: Tables
    scanner: Scanner
    valued: frozenset[str]
    """The terminals whose tokens the tree builder is given."""


@lru_cache(maxsize=1)
def automaton() -> Automaton:
    """The automaton of the language."""
    loaded = tables.load()
    return Automaton(loaded, Scanner(loaded), frozenset(loaded.valued))


def parse(source: SourceFile, report: Report) -> ast.SourceTree | None:
    """The tree of a file without the items that are broken.

    None if nothing of the file could be read.
    """
    return _Parser(source, report).run()


class _Parser:
    def __init__(self, source: SourceFile, report: Report) -> None:
        self._source = source
        self._report = report
        self._automaton = automaton()
        self._lexer = Lexer(source, self._automaton.scanner)
        self._builder = DefinitionBuilder(source, report, self._lexer.docs)

    def run(self) -> ast.SourceTree | None:
        table, _, valued = self._automaton
        actions, gotos, rules = table.actions, table.gotos, table.rules
        source, lexer = self._source, self._lexer
        builders = self._builders()
        states = [table.start]
        values: list[Any] = []
        starts: list[int] = []
        accepted = actions[table.start]
        previous_end = 0
        lexer.advance(accepted)
        while True:
            action = accepted.get(lexer.kind)
            if action is None:
                if lexer.kind == tables.END and table.symbols[states[-1]] == "start":
                    return self._tree(values[0])
                expected = ", ".join(sorted(accepted))
                self._report.add(UnexpectedText(Span(source, lexer.start, lexer.end), lexer.text, expected))
                return None
            if action >= 0:
                kind = lexer.kind
                if kind == "NAME":
                    values.append(ast.Identifier(span=Span(source, lexer.start, lexer.end), text=lexer.text))
                elif kind in valued:
                    values.append(Token(Span(source, lexer.start, lexer.end), lexer.text))
                else:
                    values.append(None)
                starts.append(lexer.start)
                states.append(action)
                accepted = actions[action]
                previous_end = lexer.end
                lexer.advance(accepted)
                continue
            rule = ~action
            origin, length, build, kept = rules[rule]
            if build is None:
                # hands on its only child: only the state changes
                states[-1] = state = gotos[states[-2]][origin]
                accepted = actions[state]
                continue
            if length:
                children = values[-length:]
                start = starts[-length]
                del values[-length:], starts[-length:], states[-length:]
            else:
                children = []
                start = lexer.start
            if build == "":
                if kept and kept[0] is not None and kept[0] < 0:
                    value = children[0]
                    value += [children[i] for i in kept[1:]]
                else:
                    value = [None if i is None else children[i] for i in kept]
            else:
                arguments = []
                for i in kept:
                    if i is None:
                        arguments.append(None)
                    elif i < 0:
                        arguments += children[~i]
                    else:
                        arguments.append(children[i])
                value = builders[rule](Span(source, start, max(start, previous_end)), *arguments)
            values.append(value)
            starts.append(start)
            state = gotos[states[-1]][origin]
            states.append(state)
            accepted = actions[state]

    def _builders(self) -> list[Callable[..., Any]]:
        builder = self._builder
        return [getattr(builder, rule.build) if rule.build else None for rule in self._automaton.tables.rules]

    def _tree(self, items: tuple[ast.Item, ...]) -> ast.SourceTree:
        source = self._source
        comments = tuple(
            ast.Comment(span=Span(source, c.start, c.end), text=c.text)
            for c in self._lexer.comments
            if not c.text.startswith("///")
        )
        return ast.SourceTree(span=Span(source, 0, len(source.text)), source=source, items=items, comments=comments)
