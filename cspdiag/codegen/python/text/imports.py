"""The imports of a generated module, collected while its text is made."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping

from cspdiag.codegen.python.text.layout import bracketed
from cspdiag.codegen.python.text.names import PackageNames


class Imports:
    """The imports of one module; each method imports a name and returns how it is spelled in the module."""

    def __init__(self, names: PackageNames, *, taken: Iterable[str] = (), dots: str = ".") -> None:
        """``taken`` are the names that have another meaning in the module; ``dots`` lead to the package."""
        self.names = names
        self._local = frozenset(taken)
        self._taken = self._local | names.globals
        self._dots = dots
        self._relative: dict[str, set[str]] = defaultdict(set)
        self._standard: dict[str, set[str]] = defaultdict(set)
        self._modules: set[str] = set()
        self._installed: dict[str, set[str]] = defaultdict(set)

    def runtime(self, name: str) -> str:
        """A name of the runtime, qualified if the module uses the plain name for something else."""
        if name in self._taken:
            self._relative[""].add("runtime")
            return f"runtime.{name}"
        self._relative["runtime"].add(name)
        return name

    def standard(self, module: str, name: str | None = None) -> str:
        """A name of the standard library, or a module of it; qualified if the module uses the plain name for something
        else.
        """
        if name is None or name in self._taken:
            self._modules.add(module)
            return module if name is None else f"{module}.{name}"
        self._standard[module].add(name)
        return name

    def class_(self, name: str) -> str:
        """A class of the network."""
        return self._from(self.names.modules[name], self.names.classes[name])

    def type_(self, name: str) -> str:
        """An enum or a struct of the text."""
        return self._from("types", self.names.types[name])

    def parameters(self) -> str:
        """The class with the parameters of the program."""
        return self._from("parameters", "Parameters")

    def exception(self, name: str) -> str:
        """An exception of the text or of the runtime."""
        if name in self.names.exceptions:
            return self._from("exceptions", self.names.exceptions[name])
        return self.runtime(name)

    def caught(self, name: str) -> list[str]:
        """The classes that a handler of an exception of the text catches: for ``Fault`` also what Python raises for a
        division by zero.
        """
        of_python = ["ArithmeticError"] if name == "Fault" and name not in self.names.exceptions else []
        return [self.exception(name), *of_python]

    def constant(self, name: str) -> str | None:
        """A ``const`` of the text; None if a name of the module hides it."""
        python = self.names.constants.get(name)
        if python is None or python in self._local:
            return None
        return self._from("constants", python)

    def body(self, module: str, name: str, *, folder: str) -> str:
        """A class written by hand, from a module that was copied into a folder of the package or from an installed one.

        It is imported as ``<name>Body`` if the package already uses its name.
        """
        wanted = self._relative[f"{folder}.{module}"] if folder else self._installed[module]
        taken = name in self._taken or name in self.names.environments.values()
        wanted.add(f"{name} as {name}Body" if taken else name)
        return f"{name}Body" if taken else name

    def _from(self, module: str, name: str) -> str:
        self._relative[module].add(name)
        return name

    def lines(self) -> list[str]:
        """The import statements, sorted as isort does, with a blank line between the groups."""
        standard = [f"import {module}" for module in sorted(self._modules)]
        standard += import_lines(self._standard, "")
        lines: list[str] = []
        for group in (standard, import_lines(self._installed, ""), import_lines(self._relative, self._dots)):
            lines += ["", *group] if lines and group else group
        return lines


def import_lines(wanted: Mapping[str, set[str]], dots: str) -> list[str]:
    """`from` statements for the names that are wanted from each module."""
    lines: list[str] = []
    for module in sorted(wanted):
        if wanted[module]:
            members = sorted(wanted[module], key=member_order)
            lines += _import_lines(f"from {dots}{module} import ", members)
    return lines


def _import_lines(start: str, members: list[str]) -> list[str]:
    line = start + ", ".join(members)
    return [line] if len(line) <= 100 else bracketed("", f"{start}(", members, ")")


def member_order(name: str) -> tuple[int, list[str | int], str]:
    """The key by which linters sort names: constants, classes, others, numbers in them as numbers."""
    plain = name.split(" ")[0]
    kind = 0 if plain.isupper() and len(plain) > 1 else 1 if plain[:1].isupper() else 2
    return kind, _natural(plain.lower()), name


def _natural(text: str) -> list[str | int]:
    """A key that compares the numbers in a text as numbers: ``int8`` comes before ``int64``."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", text)]
