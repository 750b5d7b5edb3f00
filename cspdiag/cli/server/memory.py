"""What a process that outlives a command knows about texts: their trees, and the findings in whole programs.

Everything is found by content. A path or a time decides nothing, so what is remembered is what a new check would find.
A program with FMUs is checked anew each time: what is found in it is not decided by texts alone.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.record import record
from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.model.names.described import names_fmu
from cspdiag.model.types import Real
from cspdiag.pipeline import Reader, check
from cspdiag.syntax import kept
from cspdiag.syntax.ast import SourceTree
from cspdiag.syntax.on_demand import parsed

MAX_CHARACTERS = 200_000
"""How much text is remembered, as trees and as programs. A tree takes 40 bytes for a character."""

Text = tuple[str, str]
"""A source file as a key: its name, which is part of messages, and its text."""

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


class _Recent(Generic[K, V]):
    """The values that were used last, as long as their sizes allow."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._values: dict[K, tuple[int, V]] = {}
        self._size = 0

    def get(self, key: K) -> V | None:
        entry = self._values.pop(key, None)
        if entry is None:
            return None
        self._values[key] = entry
        return entry[1]

    def put(self, key: K, value: V, size: int) -> None:
        self._size += size - self._values.pop(key, (0, None))[0]
        self._values[key] = size, value
        while self._size > self._most:
            self._size -= self._values.pop(next(iter(self._values)))[0]


@record
class Use:
    """The texts of a program that was checked: its main file and what it imports, in the order of reading."""

    main: Text
    imported: tuple[Text, ...]

    @property
    def size(self) -> int:
        """Characters in all files."""
        return sum(len(text) for _, text in (self.main, *self.imported))


class Memory:
    """Checks programs, and remembers those that it has learned."""

    def __init__(self, characters: int = MAX_CHARACTERS) -> None:
        self._trees: _Recent[Text, tuple[SourceTree, list[Diagnostic]]] = _Recent(characters)
        self._findings: _Recent[Text, tuple[Use, list[Diagnostic]]] = _Recent(characters)
        self._most = characters
        self.uses: list[Use] = []
        """The programs that were checked and can be learned."""

    def findings(self, main: SourceFile, read: Reader) -> list[Diagnostic]:
        """Everything that is wrong with a program."""
        known = self._findings.get((main.name, main.text))
        if known is not None and _is_unchanged(known[0], read):
            self.uses.append(known[0])
            return known[1]
        reading = _Reading(read)
        names_fmus = False

        def parse(source: SourceFile, report: Report) -> SourceTree:
            nonlocal names_fmus
            tree = self._parse(source, report)
            names_fmus = names_fmus or names_fmu(tree)
            return tree

        found = check(main, reading, parse=parse, for_findings=True).report.diagnostics
        if not reading.has_failed and not names_fmus:
            self.uses.append(Use((main.name, main.text), tuple(reading.texts.items())))
        return found

    def learn(self, use: Use) -> bool:
        """Remember the trees and the findings of a program, unless it is too large; it is checked for that.

        Returns whether there was anything to learn.
        """
        known = self._findings.get(use.main)
        if use.size > self._most or (known is not None and known[0] == use):
            return False
        texts = dict(use.imported)
        name, text = use.main
        main = SourceFile(name=name, text=text)
        found = check(
            main, lambda name: SourceFile(name=name, text=texts[name]), parse=self._parse, for_findings=True
        ).report.diagnostics
        self._findings.put(use.main, (use, found), use.size)
        return True

    def _parse(self, source: SourceFile, report: Report) -> SourceTree:
        key = source.name, source.text
        known = self._trees.get(key)
        if known is None:
            mistakes = Report()
            known = parsed(source, mistakes), mistakes.diagnostics
            self._trees.put(key, known, len(source.text))
        for mistake in known[1]:
            report.add(mistake)
        return known[0]


class _Reading:
    """Reads files, and notes what was read and whether anything could not be read."""

    def __init__(self, read: Reader) -> None:
        self._read = read
        self.texts: dict[str, str] = {}
        self.has_failed = False

    def __call__(self, name: str) -> SourceFile:
        try:
            source = self._read(name)
        except Exception:
            self.has_failed = True
            raise
        self.texts[name] = source.text
        return source


def _is_unchanged(use: Use, read: Reader) -> bool:
    """Whether the imported files still have the texts that they had."""
    try:
        return all(read(name).text == text for name, text in use.imported)
    except (OSError, ValueError):
        return False


def _with_kept_trees(main: SourceFile, read: Reader) -> list[Diagnostic]:
    return check(main, read, parse=kept.parse, for_findings=True).report.diagnostics


_find: Callable[[SourceFile, Reader], list[Diagnostic]] = _with_kept_trees


def remember(memory: Memory) -> None:
    """Have this process look into a memory from now on."""
    global _find
    _find = memory.findings


def findings(main: SourceFile, real: Real = "double") -> list[Diagnostic]:
    """Everything that is wrong with a program, by file and place; remembered only where ``double`` is double."""
    if real != "double":
        return check(main, read_source, parse=kept.parse, real=real).report.diagnostics
    return _find(main, read_source)
