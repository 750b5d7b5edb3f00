"""Python names for the names of the text.

A name keeps its spelling unless Python or the runtime has it already; then it gets an underscore at the end.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache

from cspdiag.base.render.snippet import on_one_line
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.lower.distinct_names import DistinctNames


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


KEYWORDS = _words(
    """
    False None True and as assert async await break class continue def del elif else except finally for from
    global if import in is lambda nonlocal not or pass raise return try while with yield
    """
)

BUILTINS = _words(
    """
    abs aiter all anext any ascii bin bool breakpoint bytearray bytes callable chr classmethod compile complex
    delattr dict dir divmod enumerate eval exec filter float format frozenset getattr globals hasattr hash hex
    id input int isinstance issubclass iter len list locals map max memoryview min next object oct open ord pow
    print property range repr reversed round set setattr slice sorted staticmethod str sum super tuple type vars
    zip
    """
)

MEMBERS = _words(
    "self name source run runs_now execute enclosing started ended owns calculate reset ends is_law has_computed _place"
)
"""What the base classes ``Process`` and ``Submodel`` define themselves."""

PROCESS_MEMBERS = MEMBERS | _words("kind steps start end fail blame checked tracked _enclosing")
"""The same with what ``Routine`` defines: a generated process has the same names at every level of optimization."""

MODULES = _words("network constants types exceptions runtime environments external")
"""Modules of a generated package that no class may be stored in."""


def identifier(text: str) -> str:
    """A Python name for a name of the text, or for several joined by dots and indexes (``pid.error``, ``cell[3]``)."""
    joined = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_") if re.search(r"\W", text, re.ASCII) else text
    if not joined or joined[0].isdigit():
        joined = f"_{joined}"
    return f"{joined}_" if joined in KEYWORDS or joined in BUILTINS else joined


def snake_case(name: str) -> str:
    """``PositionController`` as a module is called: ``position_controller``; ``PIDLoop``: ``pid_loop``."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name)
    return identifier(spaced.lower())


def indexed(name: str) -> tuple[str, int] | None:
    """``cell[3]`` and ``cell[3].out`` as (``cell``, 3) and (``cell.out``, 3); None unless there is exactly
    one index.
    """
    found = re.findall(r"\[(\d+)\]", name)
    if len(found) != 1:
        return None
    return re.sub(r"\[\d+\]", "", name), int(found[0])


class Names:
    """Gives out Python names, each once."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._names = DistinctNames(taken)
        self._given: dict[str, str] = {}

    def __getitem__(self, text: str) -> str:
        """The name that was given for a name of the text; made at the first time."""
        if text not in self._given:
            self._given[text] = self.fresh(text)
        return self._given[text]

    def __contains__(self, name: str) -> bool:
        """Whether a Python name is taken."""
        return name in self._names.taken

    def fresh(self, text: str) -> str:
        """A new name, as near to ``text`` as may be."""
        wanted = identifier(text)

        def numbered(count: int) -> str:
            return f"{wanted}_" if count == 2 and not wanted.endswith("_") else f"{wanted.rstrip('_')}_{count}"

        return self._names.fresh(wanted, numbered)


@cache
def member_names(texts: tuple[str, ...], taken: frozenset[str]) -> Mapping[str, str]:
    """Names of the members of one class, none of which begins with an underscore: a tuple with names refuses such, an
    enumeration has its own.
    """
    names = Names(taken)
    plain = {text: text.lstrip("_") or "unnamed" for text in texts}
    wanted = {text: f"n{rest}" if rest[0].isdigit() else rest for text, rest in plain.items()}
    # Those that can keep their names come first.
    ordered = sorted(texts, key=lambda text: identifier(wanted[text]) != text)
    given = {text: names.fresh(wanted[text]) for text in ordered}
    return {text: given[text] for text in texts}


class PackageNames:
    """The names that the modules of one package share: classes, their modules, types, constants and exceptions."""

    def __init__(self, network: Network) -> None:
        self.package = network.name
        self._folder = network.source.rpartition("/")[0]
        definitions = Names({"Timeout", "Fault", "IntEnum", "NamedTuple"})
        modules = Names(MODULES)
        self.classes: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.classes}
        self.types: Mapping[str, str] = {
            name: definitions[name] for name in (*(e.name for e in network.enums), *(e.name for e in network.structs))
        }
        self.constants: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.constants}
        self.exceptions: Mapping[str, str] = {
            name: definitions[name] for name in network.exceptions if name not in ("Timeout", "Fault")
        }
        self.modules: Mapping[str, str] = {entry.name: modules[snake_case(entry.name)] for entry in network.classes}
        self.environments: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.environments}
        folder = Names()
        self.environment_modules: Mapping[str, str] = {
            entry.name: folder[snake_case(entry.name)] for entry in network.environments
        }
        by_hand = {entry.name for entry in network.classes if isinstance(entry, ProcessClass) and entry.external}
        made = (python for name, python in self.classes.items() if name not in by_hand)
        self.globals = frozenset((*made, *self.types.values(), *self.constants.values()))
        self.globals |= frozenset(self.exceptions.values())

    def place(self, file: str, line: int) -> str:
        """``laws.csp:12``, the file relative to the folder of the program."""
        inside = file.removeprefix(f"{self._folder}/") if self._folder else file
        return f"{on_one_line(inside)}:{line}"
