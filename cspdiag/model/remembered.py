"""Checks of definitions that have found nothing, which need not be made again while nothing changes that matters.

The language server checks a program after each keystroke. Its trees keep the nodes of definitions that did not change
(``cspdiag.syntax.incremental``), so whether something has changed is a comparison of nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from cspdiag.base import Report
from cspdiag.base.record import field_names
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes

if TYPE_CHECKING:
    from cspdiag.model.program import Program

T = TypeVar("T")


class Checks:
    """Makes each check when it is asked for."""

    def begin(self, program: Program, report: Report) -> None:
        """The next checks are those of this program, whose names are resolved; ``report`` has what is wrong with it."""

    def end(self) -> None:
        """The checks of the program have been made."""

    def result(self, check: str, item: ast.Item, facts: str, make: Callable[[Report], T], report: Report) -> T:
        """The result of a check of an item, which adds what it finds to the report that it is given.

        It depends on nothing but the item, the definitions that it names, directly or by others, and ``facts``.
        """
        return make(report)


ALWAYS = Checks()


class RememberedChecks(Checks):
    """Makes a check only if it may have another result than the last time.

    A check is remembered if it finds nothing in a program without errors: then every name means what its definition
    says, and nothing was left out. What was not asked for in such a program is forgotten after it.
    """

    def __init__(self) -> None:
        self._report = Report()
        self._definitions: dict[str, ast.Definition] = {}
        self._known: dict[_Key, _Known] = {}
        self._asked: dict[_Key, _Known] = {}
        self._words: dict[ast.Item, frozenset[str]] = {}
        self._named: dict[ast.Item, frozenset[ast.Item]] = {}
        self.made = 0
        """How many checks were made."""

    def begin(self, program: Program, report: Report) -> None:
        """The next checks are those of this program, whose names are resolved; ``report`` has what is wrong with it."""
        assert not program.overrides
        self._report = report
        self._definitions = program.definitions
        self._asked = {}
        present = (item for tree in program.trees for item in tree.items)
        self._words = {item: self._words[item] for item in present if item in self._words}
        self._named = {}

    def end(self) -> None:
        """The checks of the program have been made."""
        if not self._report.has_errors:
            self._known = self._asked

    def result(self, check: str, item: ast.Item, facts: str, make: Callable[[Report], T], report: Report) -> T:
        """The result of a check of an item, as above."""
        if self._report.has_errors:
            self.made += 1
            return make(report)
        key = check, item, facts
        named = self._all_named(item)
        known = self._known.get(key)
        if known is not None and known[0] == named:
            self._asked[key] = known
            result: T = known[1]
            return result
        self.made += 1
        own = Report()
        result = make(own)
        for found in own.diagnostics:
            report.add(found)
        if not own.diagnostics:
            self._asked[key] = named, result
        return result

    def _all_named(self, item: ast.Item) -> frozenset[ast.Item]:
        """An item with the definitions that it names, directly or by others. A word in it that means something else
        there counts, too.
        """
        known = self._named.get(item)
        if known is None:
            met, pending = {item}, [item]
            while pending:
                for word in self._words_in(pending.pop()):
                    named = self._definitions.get(word)
                    if named is not None and named not in met:
                        met.add(named)
                        pending.append(named)
            known = self._named[item] = frozenset(met)
        return known

    def _words_in(self, item: ast.Item) -> frozenset[str]:
        known = self._words.get(item)
        if known is None:
            values = (getattr(part, name) for part in nodes(item) for name in field_names(part))
            known = self._words[item] = frozenset(value for value in values if isinstance(value, str))
        return known


_Key: TypeAlias = "tuple[str, ast.Item, str]"
_Known: TypeAlias = "tuple[frozenset[ast.Item], Any]"
"""The definitions on which a result depends, and the result."""
