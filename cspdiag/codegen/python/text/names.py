"""Python names for the names of the text.

A name keeps its spelling unless Python or the runtime already uses it; then an underscore is appended. Python gives
names that begin with two underscores a meaning of its own, so these get an ``x`` before them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from cspdiag.codegen.shared.names import GivenNames, Package, as_one_word, stem, with_underscores, words
from cspdiag.network.ir.network import Network, ProcessClass

KEYWORDS = words(
    """
    False None True and as assert async await break class continue def del elif else except finally for from
    global if import in is lambda nonlocal not or pass raise return try while with yield
    """
)

BUILTINS = words(
    """
    abs aiter all anext any ascii bin bool breakpoint bytearray bytes callable chr classmethod compile complex
    delattr dict dir divmod enumerate eval exec filter float format frozenset getattr globals hasattr hash hex
    id input int isinstance issubclass iter len list locals map max memoryview min next object oct open ord pow
    print property range repr reversed round set setattr slice sorted staticmethod str sum super tuple type vars
    zip
    """
)

MEMBERS = words(
    "self name source run runs_now execute enclosing started ended owns calculate reset ends is_law has_computed _place"
)
"""The names that the base classes ``Process`` and ``Submodel`` define."""

PROCESS_MEMBERS = MEMBERS | words("kind steps start end fail blame checked tracked _enclosing")
"""The same with those of ``Routine``: a generated process has the same names at every level of optimization."""

INTEGRATION_LOCALS = words("h half sixth step t time")
"""Parameters and local variables of an integration that have the same name in all functions."""

_LOCALS = INTEGRATION_LOCALS | words(
    "self name now drivers parameters steps slope k1 k2 k3 k4 observe scheduler me runtime math"
)
"""Parameters and local variables of generated functions, and modules, which would hide a definition of the program."""

PARAMETERS_MEMBERS = words("self names follow next_change plan reach refused _coming _lock _made")
"""The names that the base class ``ProgramParameters`` defines."""
MODULES = words("network constants types exceptions runtime environments external devices")
"""Modules of a generated package, which no class may be stored in."""


def identifier(text: str) -> str:
    """A Python name for a name of the text, or for several joined by dots and indexes (``pid.error``, ``cell[3]``)."""
    joined = as_one_word(text)
    if not joined or joined[0].isdigit():
        joined = f"_{joined}"
    if joined.startswith("__"):
        return f"x{joined}"
    return f"{joined}_" if joined in KEYWORDS or joined in BUILTINS else joined


def snake_case(name: str) -> str:
    """The module name for ``PositionController`` is ``position_controller``, for ``PIDLoop`` it is ``pid_loop``."""
    return identifier(with_underscores(name))


class Names(GivenNames):
    """Python names, each given only once."""

    _identifier = staticmethod(identifier)

    @staticmethod
    def _numbered(wanted: str, count: int) -> str:
        return f"{wanted}_" if count == 2 and not wanted.endswith("_") else f"{wanted.rstrip('_')}_{count}"


@cache
def member_names(texts: tuple[str, ...], taken: frozenset[str]) -> Mapping[str, str]:
    """Names for the members of one class. None begins with an underscore: named tuples do not allow that, and
    enumerations reserve such names.
    """
    names = Names(taken)
    plain = {text: text.lstrip("_") or "unnamed" for text in texts}
    wanted = {text: f"n{rest}" if rest[0].isdigit() else rest for text, rest in plain.items()}
    # Those that can keep their names come first.
    ordered = sorted(texts, key=lambda text: identifier(wanted[text]) != text)
    given = {text: names.fresh(wanted[text]) for text in ordered}
    return {text: given[text] for text in texts}


class PackageNames(Package):
    """The names that the modules of one package share: classes, their modules, types, constants and exceptions."""

    def __init__(self, network: Network) -> None:
        super().__init__(network)
        own = words("Parameters" if network.parameters else "")
        definitions = Names({"Timeout", "Fault", "IntEnum", "NamedTuple"} | _LOCALS | own)
        modules = Names(MODULES | words("parameters" if network.parameters else ""))
        self.classes: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.classes}
        self.types: Mapping[str, str] = {
            name: definitions[name] for name in (*(e.name for e in network.enums), *(e.name for e in network.structs))
        }
        self.constants: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.constants}
        attributes = Names(PARAMETERS_MEMBERS)
        self.parameters: Mapping[str, str] = {entry.name: attributes[entry.name] for entry in network.parameters}
        self.exceptions: Mapping[str, str] = {
            name: definitions[name] for name in network.exceptions if name not in ("Timeout", "Fault")
        }
        self.modules: Mapping[str, str] = {
            entry.name: modules.fresh(stem(snake_case(entry.name))) for entry in network.classes
        }
        self.environments: Mapping[str, str] = {entry.name: definitions[entry.name] for entry in network.environments}
        folder = Names()
        self.environment_modules: Mapping[str, str] = {
            entry.name: folder.fresh(stem(snake_case(entry.name))) for entry in network.environments
        }
        by_hand = {entry.name for entry in network.classes if isinstance(entry, ProcessClass) and entry.external}
        made = (python for name, python in self.classes.items() if name not in by_hand)
        self.globals = frozenset((*made, *self.types.values(), *self.constants.values()))
        self.globals |= frozenset(self.exceptions.values())
