"""The common part of the names in generated code, for all languages."""

from __future__ import annotations

import re
from collections.abc import Iterable

from cspdiag.base.render.snippet import on_one_line
from cspdiag.network.ir.network import Network
from cspdiag.network.lower.distinct_names import DistinctNames


def words(text: str) -> frozenset[str]:
    """The words of a list."""
    return frozenset(text.split())


def as_one_word(text: str) -> str:
    """A name of the text, or several joined by dots and indexes, with letters, digits and underscores only."""
    if text.isascii() and text.isidentifier():
        return text
    return re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_") if re.search(r"\W", text, re.ASCII) else text


def with_underscores(name: str) -> str:
    """``PositionController`` as ``position_controller``; ``PIDLoop`` as ``pid_loop``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


_LONGEST = 100
"""Letters of the name of a file without its ending. File systems have room for 255."""


def stem(name: str) -> str:
    """The name of a file for a name in generated code."""
    return name[:_LONGEST]


class GivenNames:
    """Names of a language, each given only once."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._names = DistinctNames(taken)
        self._given: dict[str, str] = {}

    def __getitem__(self, text: str) -> str:
        """The name for a name of the text, created at the first access."""
        if text not in self._given:
            self._given[text] = self.fresh(text)
        return self._given[text]

    def __contains__(self, name: str) -> bool:
        """Whether a name of the language is taken."""
        return name in self._names.taken

    def avoid(self, names: Iterable[str]) -> None:
        """Take names, so that no further one is among them."""
        self._names.taken.update(names)

    def fresh(self, text: str) -> str:
        """A new name, as similar to ``text`` as possible."""
        wanted = self._identifier(text)
        return self._names.fresh(wanted, lambda count: self._numbered(wanted, count))

    @staticmethod
    def _identifier(text: str) -> str:
        """A name of the language for one of the text."""
        raise NotImplementedError

    @staticmethod
    def _numbered(wanted: str, count: int) -> str:
        return f"{wanted.rstrip('_')}_{count}"


class Package:
    """The package that is generated from a network: its name, and its place in the text."""

    def __init__(self, network: Network) -> None:
        self.package = network.name
        self._folder = network.source.rpartition("/")[0]

    def place(self, file: str, line: int) -> str:
        """``laws.csp:12``, the file relative to the folder of the program."""
        inside = file.removeprefix(f"{self._folder}/") if self._folder else file
        return f"{on_one_line(inside)}:{line}"
