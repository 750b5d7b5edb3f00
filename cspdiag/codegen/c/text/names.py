"""Names in generated C: those of the source text, changed where they clash with C or its library."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.codegen.shared.names import GivenNames, Package, as_one_word, with_underscores, words
from cspdiag.network.ir.network import Network

RESERVED = words(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    bool true false NULL main self asm fortran typeof near far huge interrupt
    abs acos asin atan atan2 ceil cos cosh exp exp2 expm1 fabs floor fma fmax fmin fmod frexp gamma hypot isfinite isinf
    isnan j0 j1 jn ldexp lgamma log log10 log1p log2 logb modf nan pow remainder rint round scalb signbit significand
    sin
    sinh sqrt tan tanh trunc y0 y1 yn drem infinity
    abort assert atexit atof atoi bsearch calloc clock difftime div errno exit fclose feof fflush fopen fprintf fread
    free
    fputs fwrite getc getchar getenv index labs ldiv localtime longjmp malloc memchr memcmp memcpy memmove memset mktime
    offsetof perror printf putc putchar puts qsort raise rand realloc remove rename rewind rindex scanf setjmp signal
    sprintf srand stderr stdin stdout strcat strchr strcmp strcpy strlen strncpy strstr strtod strtol system time
    tmpfile
    toupper tolower ungetc
    accept alarm bind brk close connect creat dup environ exec execl execv fork getpid kill link listen lseek nice open
    pause pipe poll read recv select send shutdown sleep socket stat sync times truncate unlink usleep wait write yield
    linux unix i386 stdin int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t ptrdiff_t
    """
)
"""Keywords of C, and names of its library and of POSIX that are built into compilers or defined in headers."""


def identifier(text: str) -> str:
    """A C name for a name of the source text, or for a path with dots and indexes (``pid.error``, ``cell[3]``)."""
    joined = as_one_word(text)
    if not joined or joined[0].isdigit():
        joined = f"n{joined}"
    if joined.startswith("_"):
        joined = f"x{joined}"
    clashes = joined in RESERVED or f"{joined.lower()}_".startswith("csp_") or joined in _MACROS
    return f"{joined}_" if clashes else joined


_MACROS = words("EOF INFINITY NAN NULL DOMAIN OVERFLOW UNDERFLOW SING PLOSS TLOSS HUGE M_PI I BUFSIZ")


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


def library_name(package: str) -> str:
    """The name of the library of a package, without ``lib`` and ``.a``."""
    return f"{package}_" if package in _LIBRARIES | _TARGETS else package


class Names(GivenNames):
    """Gives out C names, each once."""

    _identifier = staticmethod(identifier)


HEADERS = words(
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic "
    "stdbool stddef stdint stdio "
    "stdlib stdnoreturn string tgmath threads time uchar wchar wctype dirent fcntl poll pthread sched semaphore "
    "strings termios unistd"
)
"""Headers of C and POSIX: the folder of the package is searched first, so a generated header of the same name would
hide the standard one.
"""

FILES = (
    "types",
    "constants",
    "network",
    "main",
    "main_simulation",
    "port",
    "exceptions",
    "environment",
    "values",
    "types_by_hand",
)
"""Stems of files of a package, which no class may be named after."""

_NETWORK_NAMES = words("external present brought port_table process_name channel_name exception_names copy_name")
"""Names in the file that builds the network, besides that of the outermost process."""


class PackageNames(Package):
    """The names that all files of one package share.

    A class has one name, which its struct and its files have and its functions begin with. Constants and enum literals
    have global names in C.
    """

    def __init__(self, network: Network) -> None:
        super().__init__(network)
        interface = (f"{library_name(self.package)}_{part}" for part in ("api", "types"))
        self._names = Names((*FILES, *HEADERS, *_NETWORK_NAMES, *interface))
        self.types: Mapping[str, str] = {
            name: self._fresh(name) for name in (*(e.name for e in network.enums), *(e.name for e in network.structs))
        }
        by_hand = {entry.definition: snake_case(entry.definition) for entry in network.classes if entry.external}
        for name in by_hand.values():
            self._names.fresh(name)
        self.classes: Mapping[str, str] = {
            entry.name: by_hand[entry.definition] if entry.external else self._fresh(entry.name)
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
        self.literals: Mapping[str, tuple[str, ...]] = {
            enum.name: tuple(
                self._names.fresh(f"{snake_case(enum.name)}_{snake_case(name)}".upper()) for name in enum.literals
            )
            for enum in network.enums
        }
        self.constants: Mapping[str, str] = {entry.name: self._names.fresh(entry.name) for entry in network.constants}
        self.globals = frozenset(
            (*self.constants.values(), *(name for names in self.literals.values() for name in names))
        )

    def _fresh(self, name: str) -> str:
        return self._names.fresh(snake_case(name))
