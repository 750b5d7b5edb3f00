"""Names in generated C: those of the source text, changed where they clash with C or its library."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from cspdiag.codegen.c.text.reserved import is_header, is_reserved
from cspdiag.codegen.shared.names import GivenNames, Package, as_one_word, stem, with_underscores, words
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import Network, SubmodelClass


def identifier(text: str) -> str:
    """A C name for a name of the source text, or for a path with dots and indexes (``pid.error``, ``cell[3]``)."""
    joined = as_one_word(text)
    if not joined or joined[0].isdigit():
        joined = f"n{joined}"
    if joined.startswith("_"):
        joined = f"underscore{joined}"
    if _is_of_kernel(joined):
        joined = f"x{joined}"
    return f"{joined}_" if is_reserved(joined) else joined


def member_name(text: str) -> str:
    """A C name for a name of the source text that no other name has: what looks like a changed name is changed, too."""
    name = identifier(text)
    if name != text:
        return name
    plain = name.lstrip("x")
    if plain.startswith("underscore_") or _is_of_kernel(plain):
        return f"x{name}"
    return f"{name}_" if is_reserved(name.rstrip("_")) else name


def _is_of_kernel(name: str) -> bool:
    """Whether names and files of the kernel begin so."""
    return f"{name.lower()}_".startswith("csp_")


def snake_case(name: str) -> str:
    """``PositionController`` as ``position_controller``; ``PIDLoop`` as ``pid_loop``."""
    return identifier(with_underscores(name))


_LIBRARIES = words(
    """
    m c g pthread rt dl util gcc gcc_s gcc_eh gcov stdc++ supc++ atomic gomp quadmath asan ubsan tsan lsan ssp nosys
    rdimon semihost
    anl crypt nsl resolv mvec thread_db z bz2 lzma ssl crypto ncurses curses readline uuid ffi
    """
)
"""Common libraries of systems and tool chains: a package of the same name would be linked instead of one of them, or to
itself.
"""

_TARGETS = words(
    "all clean depend edit_cache help install list_install_components package package_source preinstall rebuild_cache "
    "test zero_check"
)
"""Targets that CMake predefines."""


PUBLIC_HEADERS = ("api", "types")
"""What the names of the headers of a package end with that users include; they begin with its name."""


def library_name(package: str) -> str:
    """The name of the library of a package, without ``lib`` and ``.a``, with which its names begin."""
    if _is_of_kernel(package):
        return f"x{package}"
    hides_header = any(is_header(f"{package}_{part}") for part in PUBLIC_HEADERS)
    return f"{package}_" if hides_header or package in _LIBRARIES | _TARGETS else package


class Names(GivenNames):
    """Gives out C names, each once."""

    _identifier = staticmethod(identifier)


FILES = (
    "types",
    "constants",
    "network",
    "network_names",
    "network_pointers",
    "network_functions",
    "main",
    "main_simulation",
    "port",
    "exceptions",
    "environment",
    "fmu",
    "fmu_model",
    "fmi2",
    "fmi3",
    "values",
    "types_by_hand",
)
"""Stems of files of a package, which no class may be named after."""

_INTERFACE = words(
    """
    memory instance input inputs output outputs event hooks state begin advance continues next hand_over finish
    release stop save restore describe times write_times port communication cause failure diagnose channel_name
    process_name api types build size_is_too_small
    alignment_is_too_small aligned_memory aligned_instance parameter refusal why_refused
    """
)
"""What names of the interface end with, after the name of the package."""

_INTERFACE_CONSTANTS = words(
    "SIZE PROCESSES API_H TYPES_H MORE BUDGET REFUSED ENDED FAILED DEADLOCK STOPPED IN OUT EVENT "
    "CAUSE_FAULT CAUSE_TIMEOUT CAUSE_EXCEPTION CAUSE_DEADLOCK PARAMETER "
    "REFUSAL_NONE REFUSAL_NOT_FINITE REFUSAL_NOT_COMPUTED"
)
"""The same for its constants and macros."""

_NETWORK_NAMES = words(
    """
    external present brought port_table process_name channel_name exception_names copy_name refuse follow set_parameters
    network_initialize network_program network_drivers network_change_parameters network_default_parameters
    network_variable_names
    network_process_names network_process_count network_process_kinds
    network_channel_names network_channel_sizes network_channel_count
    """
)
"""Names in the files that build the network, besides that of the outermost process."""


INTEGRATION_LOCALS = words("h half sixth step steps t time k1 k2 k3 k4 slope slopes")
"""Local variables of an integration."""

PROCESS_LOCALS = words("process party progress condition numbers ports samples first_report index i")
"""Parameters and local variables of the functions of processes."""

ENVIRONMENT_LOCALS = INTEGRATION_LOCALS | words("program now present self state device value last")
"""Parameters and local variables of the functions of environments."""

_LOCALS = (
    PROCESS_LOCALS | ENVIRONMENT_LOCALS | words("number input context drivers hooks before cause changed parameters")
)
"""Parameters and local variables of generated functions, which would hide a constant of the program."""


_OWN = words(
    """
    advance branches calculate class count defaults drivers evaluate fails initialize kinds members names places ports
    program reset set sizes slopes start step
    """
)
"""The last words of the functions and tables of a class or an environment, whose names begin with its name. Those of
the network and of safe values end in names of ports, too.
"""


_KINDS = words("bool double float int8 int16 int32 int64 uint8 uint16 uint32 uint64 csp_time")


class PackageNames(Package):
    """The names that all files of one package share.

    A class has one name, which its struct and its files have and its functions begin with. Constants have global names
    in C. What users of the program see begins with ``prefix``: types, enum literals and the interface.
    """

    def __init__(self, network: Network) -> None:
        super().__init__(network)
        self.prefix = library_name(self.package)
        of_parameters = words("parameters defaults get set" if network.parameters else "")
        interface = (
            *(f"{self.prefix}_{part}" for part in (*_INTERFACE, *sorted(of_parameters))),
            *(f"{self.prefix}_{part}".upper() for part in _INTERFACE_CONSTANTS),
        )
        self.interface = frozenset(interface)
        """The names of the interface that are the same in each program, but for the prefix."""
        self._names = Names((*FILES, *_NETWORK_NAMES, *interface))
        self.types: Mapping[str, str] = {
            name: self.public(with_underscores(name))
            for name in (*(e.name for e in network.enums), *(e.name for e in network.structs))
        }
        self.literals: Mapping[str, tuple[str, ...]] = {
            enum.name: tuple(
                self.public_constant(f"{with_underscores(enum.name)}_{with_underscores(name)}")
                for name in enum.literals
            )
            for enum in network.enums
        }
        drivers = [driver for entry in network.environments for driver in entry.drivers]
        by_hand = {entry.definition: snake_case(entry.definition) for entry in network.classes if entry.external}
        by_hand |= {
            entry.definition: snake_case(entry.definition) for entry in drivers if entry.external.language == "c"
        }
        for name in by_hand.values():
            self._names.fresh(name)
        variables = frozenset(_variables(network))
        self.classes: Mapping[str, str] = {
            entry.name: by_hand[entry.definition] if entry.external else self._name_of_class(entry.name, variables)
            for entry in network.classes
        }
        self.environments: Mapping[str, str] = {
            entry.name: self._fresh(f"{entry.name}_environment") for entry in network.environments
        }
        self.exceptions: Mapping[str, str] = {
            name: self._names.fresh(f"EXCEPTION_{snake_case(name).upper()}")
            for name in network.exceptions
            if name not in ("Timeout", "Fault")
        }
        self._names.avoid(_LOCALS)
        kinds = (*_KINDS, *self.types.values())
        self._names.avoid(f"{verb}_{kind}" for verb in ("read", "write", "poll") for kind in kinds)
        owners = tuple(f"{name}_" for name in (*self.classes.values(), *self.environments.values()))
        self._names.avoid(
            entry.name
            for entry in network.constants
            if entry.name.startswith(("network_", "safe_"))
            or (entry.name.startswith(owners) and entry.name.rpartition("_")[2] in _OWN)
        )
        self.constants: Mapping[str, str] = {entry.name: self._names.fresh(entry.name) for entry in network.constants}
        self.macros = frozenset(f"{self.prefix}_{part}".upper() for part in ("SIZE", "PROCESSES"))
        """The macros of the interface, which would be expanded in members and local variables, too."""
        members = Names(self.macros)
        self.parameters: Mapping[str, str] = {entry.name: members[entry.name] for entry in network.parameters}
        self.globals = frozenset(
            (*self.constants.values(), *(name for names in self.literals.values() for name in names), *self.macros)
        )

    def public(self, name: str) -> str:
        """A new name of a type or a function that users of the program see."""
        return self._names.fresh(f"{self.prefix}_{as_one_word(name)}")

    def internal(self, name: str) -> str:
        """A new name of a function that only its own file sees."""
        return self._names.fresh(name)

    def public_constant(self, name: str) -> str:
        """The same of a constant, in upper case."""
        return self._names.fresh(f"{self.prefix}_{as_one_word(name)}".upper())

    def _name_of_class(self, name: str, variables: Collection[str]) -> str:
        """A new name with which no function or table has the name of one of the ``variables``, which would hide it."""
        while True:
            found = self._fresh(name)
            if not any(f"{found}_{own}" in variables for own in _OWN):
                return found

    def _fresh(self, name: str) -> str:
        """A new name of files: the folder of the package is searched first, so a header that is called like one of
        the C library would hide it, also from the library itself.
        """
        wanted = stem(snake_case(name))
        return self._names.fresh(f"{wanted}_2" if is_header(wanted) else wanted)


def _variables(network: Network) -> Iterator[str]:
    """Names that functions may have for parameters and variables of their own."""
    for entry in network.classes:
        yield from (identifier(item.name) for item in entry.parameters)
        if isinstance(entry, SubmodelClass):
            named = (*entry.constants, *entry.states, *entry.equations, *entry.derivative_equations)
            yield from (identifier(item.name) for item in named if not isinstance(item, ExternalCall))
