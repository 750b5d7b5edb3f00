"""The parse tables: made from the grammar by Lark once, stored in the cache of the user, and then used without Lark.

Importing Lark and loading its own cached tables takes half of the time that ``cspdiag check`` may take. So the tables
are stored as plain lists and dictionaries, which ``marshal`` reads in a millisecond.
"""

from __future__ import annotations

import marshal
import os
import sys
import zlib
from typing import Any, NamedTuple

from cspdiag.base.files import resources
from cspdiag.base.files.caches import cache_folder, store

END = "$END"
"""The terminal after the last token."""

_FORMAT = 1
"""The version of the cache, to be increased when the layout of ``Tables`` or its meaning changes."""


class Rule(NamedTuple):
    """How a reduction combines the values of its right-hand side.

    ``build`` is the name of the method of the tree builder. It is None for a rule that passes its only child on, and
    empty for the helper rules of repetitions, whose values are lists. ``kept`` are the positions of the children that
    are passed to the method: None for an absent optional part, ``~i``, which is negative, for a list at position ``i``
    that is spliced in.
    """

    origin: str
    length: int
    build: str | None
    kept: tuple[int | None, ...]


class Tables(NamedTuple):
    """An LALR(1) automaton, and the tables of the lexer.

    ``actions[state]`` maps a terminal to the next state, or to ``~rule`` for a reduction; ``gotos[state]`` maps the
    origin of a reduced rule to the next state; ``symbols[state]`` is the symbol that leads to a state.
    """

    actions: list[dict[str, int]]
    gotos: list[dict[str, int]]
    symbols: list[str]
    rules: list[Rule]
    start: int
    words: dict[str, str]
    """Keywords and punctuation: text to terminal."""
    patterns: list[tuple[str, str]]
    """The other terminals and their regular expressions, the more specific ones first."""
    valued: list[str]
    """The terminals with values in the tree; the others only separate them."""


def load() -> Tables:
    """The tables of the grammar, from the cache if it has them."""
    grammar = resources.grammar()
    try:
        path = os.path.join(cache_folder(), _cache_name(grammar))
    except OSError:
        return build(grammar)
    cached = _read(path, grammar)
    if cached is None:
        cached = build(grammar)
        _write(path, grammar, cached)
    return cached


def _cache_name(grammar: str) -> str:
    version = f"{sys.implementation.cache_tag}-{_FORMAT}"
    return f"grammar-{zlib.crc32(grammar.encode()):08x}-{version}.tables"


def _read(path: str, grammar: str) -> Tables | None:
    try:
        with open(path, "rb") as file:
            stored_grammar, fields = marshal.loads(file.read())
        if stored_grammar != grammar:
            return None
        tables = Tables(*fields)
        return tables._replace(rules=[Rule(*rule) for rule in tables.rules])
    except (OSError, ValueError, EOFError, TypeError):
        return None


def _write(path: str, grammar: str, tables: Tables) -> None:
    rules: Any = [tuple(rule) for rule in tables.rules]
    store(path, marshal.dumps((grammar, tuple(tables._replace(rules=rules)))))


def build(grammar: str) -> Tables:
    """The tables of a grammar in the notation of Lark.

    Raises lark.exceptions.GrammarError if it is not an LALR(1) grammar.
    """
    from lark import Lark

    parser = Lark(grammar, parser="lalr", maybe_placeholders=True)
    table: Any = parser.parser.parser._parse_table
    rules: dict[Any, int] = {}
    actions: list[dict[str, int]] = []
    gotos: list[dict[str, int]] = []
    symbols = [""] * len(table.states)
    numbers = {state: number for number, state in enumerate(table.states)}
    origins = {str(rule.origin.name) for rule in parser.rules}
    for row in table.states.values():
        actions.append({})
        gotos.append({})
        for symbol, (action, argument) in row.items():
            symbol = sys.intern(str(symbol))
            if action.name == "Reduce":
                actions[-1][symbol] = ~rules.setdefault(argument, len(rules))
            else:
                symbols[numbers[argument]] = symbol
                row_of_symbol = gotos[-1] if symbol in origins else actions[-1]
                row_of_symbol[symbol] = numbers[argument]
    literals = {t.pattern.value: str(t.name) for t in parser.terminals if t.pattern.type == "str"}
    expressions = [t for t in parser.terminals if t.pattern.type == "re"]
    expressions.sort(key=lambda t: -t.priority)
    return Tables(
        actions=actions,
        gotos=gotos,
        symbols=symbols,
        rules=[_rule_of(rule) for rule in rules],
        start=numbers[table.start_states["start"]],
        words=literals,
        patterns=[(str(t.name), t.pattern.value) for t in expressions],
        valued=sorted(
            {
                str(symbol.name)
                for rule in rules
                for symbol in rule.expansion
                if symbol.is_term and (rule.options.keep_all_tokens or not symbol.filter_out)
            }
        ),
    )


def _rule_of(rule: Any) -> Rule:
    """The rule with what Lark's own tree builder would do for it, as data."""
    origin = str(rule.origin.name)
    absent_before = [0] * (len(rule.expansion) + 1)
    position = 0
    for absent in rule.options.empty_indices or ():
        if absent:
            absent_before[position] += 1
        else:
            position += 1
    kept: list[int | None] = []
    for position, symbol in enumerate(rule.expansion):
        kept += [None] * absent_before[position]
        if not symbol.is_term and symbol.name.startswith("_"):
            kept.append(~position)
        elif rule.options.keep_all_tokens or not (symbol.is_term and symbol.filter_out):
            kept.append(position)
    kept += [None] * absent_before[len(rule.expansion)]
    if origin.startswith("_"):
        build: str | None = ""
    elif rule.options.expand1 and rule.alias is None:
        build = None
    else:
        build = str(rule.alias or origin)
    return Rule(sys.intern(origin), len(rule.expansion), build, tuple(kept))
