"""A program as it is at present, seen from one of its files."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from hashlib import sha256

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.files.content import digest_of_file
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.draw.elements.facts import Facts
from cspdiag.editing.occurrences import Occurrences
from cspdiag.editing.proved import Proved
from cspdiag.model.names.described import with_described_ports
from cspdiag.model.names.imports import load
from cspdiag.model.names.resolve import resolve
from cspdiag.model.program import Program
from cspdiag.model.remembered import ALWAYS, Checks
from cspdiag.network.lower.external_bodies import files_of_bodies
from cspdiag.pipeline import Checked, Reader, check
from cspdiag.syntax import ast
from cspdiag.syntax.parse.nesting import raised_recursion_limit

Parse = Callable[[SourceFile, Report], ast.SourceTree]


class View:
    """A program with everything that features need to know of it, computed when it is first needed.

    A text that is half typed has a tree, too: without the declarations that could not be read. What is known then is
    what the rest says.
    """

    def __init__(self, main: SourceFile, read: Reader, parse: Parse, checks: Checks = ALWAYS) -> None:
        self.main = main
        self._checks = checks
        self._read = read
        self._parse = parse
        self.trees: dict[str, ast.SourceTree] = {}
        """The trees of its files by name, as far as they were asked for."""
        self.texts: dict[str, str | None] = {}
        """The imported files with their texts, None for those that could not be read."""
        self.bodies: dict[str, str | None] = {}
        """The files that it names as bodies, such as FMUs, with a digest of their content, None for those that cannot
        be read.
        """
        self._occurrences: dict[str, Occurrences] = {}
        self.answers: dict[int, Proved] = {}
        """What was proved of the assertions of the main file, by the offset at which they begin."""

    def _noted(self, name: str) -> SourceFile:
        self.texts[name] = None
        source = self._read(name)
        self.texts[name] = source.text
        return source

    def _tree(self, source: SourceFile, report: Report) -> ast.SourceTree:
        tree = self.trees[source.name] = self._parse(source, report)
        # Before one is read: should it change meanwhile, it is read again.
        self.bodies.update({path: digest_of_file(path) for path in files_of_bodies(tree)})
        return tree

    @cached_property
    def checked(self) -> Checked:
        """The program after all checks."""
        return check(self.main, self._noted, parse=self._tree, checks=self._checks, for_findings=True)

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Everything that is wrong with the program, by file and place, and the assertions that fail."""
        refuted = [each.found for each in self.answers.values() if each.found is not None]
        return [*self.checked.report.diagnostics, *refuted]

    @cached_property
    @raised_recursion_limit()
    def program(self) -> Program:
        """The program with the meanings of its names, as far as they could be found; it does not need the checks."""
        if "checked" in vars(self) and self.checked.program is not None:
            return self.checked.program
        trees = with_described_ports(load(self.main, self._noted, Report(), self._tree))
        return resolve(trees, {}, Report())

    @property
    def tree(self) -> ast.SourceTree:
        """The tree of the main file."""
        return self.program.main

    @cached_property
    @raised_recursion_limit()
    def facts(self) -> Facts:
        """The inferred kinds and periods."""
        fewer = self.checked.fewer
        if fewer is not None and fewer.checked.program is not None:
            return Facts(fewer.checked.program, fewer.checked.analysis)
        return Facts(self.program, self.checked.analysis)

    @property
    def sources(self) -> dict[str, SourceFile]:
        """The files of the program by name, the main one first."""
        return {tree.source.name: tree.source for tree in self.program.trees}

    @property
    def files(self) -> dict[str, str | None]:
        """The texts of all files of the program by name, None for those that could not be read."""
        assert self.program is not None  # It has read them.
        return {**self.texts, self.main.name: self.main.text}

    @cached_property
    def fingerprint(self) -> str:
        """The same for programs of the same files with the same texts, and bodies in files with the same content."""
        return sha256(repr((sorted(self.files.items()), sorted(self.bodies.items()))).encode()).hexdigest()

    def occurrences(self, name: str) -> Occurrences:
        """The names in a file of the program."""
        known = self._occurrences.get(name)
        if known is None:
            tree = next(tree for tree in self.program.trees if tree.source.name == name)
            known = self._occurrences[name] = Occurrences(self.program, tree)
        return known

    @property
    def here(self) -> Occurrences:
        """The names in the main file."""
        return self.occurrences(self.main.name)
