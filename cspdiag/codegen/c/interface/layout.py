"""How large the structures of a generated package are at most, from their definitions: no compiler is needed.

Sizes are those of machines with pointers of 8 or of 4 bytes; with shorter pointers no structure is larger.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.declarations import declared_types, type_named
from cspdiag.codegen.c.interface.directives import Macros, included_in, without_comments
from cspdiag.codegen.c.interface.lengths import Lengths
from cspdiag.codegen.c.interface.structures import (
    Array,
    CType,
    Either,
    Function,
    Named,
    NotUnderstood,
    Pointer,
    Structure,
    either,
)
from cspdiag.codegen.shared.target_error import TargetError

_SCALARS = {
    "bool": 1, "_Bool": 1, "char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4,
    "uint32_t": 4, "float": 4, "int64_t": 8, "uint64_t": 8, "double": 8, "intmax_t": 8, "uintmax_t": 8,
    "wchar_t": 4, "wint_t": 4, "sig_atomic_t": 4, "time_t": 8, "clock_t": 8, "char16_t": 2, "char32_t": 4,
    "float_t": 16, "double_t": 16,
    **{f"{sign}int_{kind}{bits}_t": 8 for sign in ("", "u") for kind in ("fast", "least") for bits in (8, 16, 32, 64)},
}  # fmt: skip
_AS_POINTERS = frozenset({"size_t", "ptrdiff_t", "intptr_t", "uintptr_t", "csp_word"})
_INTEGER = frozenset({"signed", "unsigned", "char", "short", "int", "long"})
"""The words of which the names of C's own integers are made."""
_LARGEST = 16
"""The bytes of ``long double``, and the alignment of any type."""


@record
class Extent:
    """The bytes of a type, and the multiples of which its addresses are."""

    size: int
    alignment: int


class Layout:
    """The types that headers define, by name; ``struct x`` and ``x`` are the same."""

    def __init__(self, headers: Mapping[str, str], constants: Mapping[str, int]) -> None:
        """The texts of ``headers`` by path."""
        self._lengths = Lengths(constants, self._size_of)
        self._types: dict[str, CType] = {}
        self._known: dict[tuple[str, int], Extent] = {}
        self._pointer = 8
        self._places: dict[str, tuple[str, int]] = {}
        """The header of each type, and the line."""
        self._computed: list[str] = []
        """The names of the types that are computed, each inside the one before."""
        self._within: list[tuple[str, int]] = []
        """Where the structures are that are computed, each inside the one before: its header, and the line."""
        self._texts = {path: without_comments(text) for path, text in headers.items()}
        for text in self._texts.values():
            self._lengths.add(text)
        self._macros: dict[str, Macros] = {}
        for path in self._texts:
            self._read(path)

    def _read(self, path: str) -> Macros:
        """Read the definitions of a header and of those that it includes; its macros."""
        if path not in self._macros:
            self._macros[path] = Macros(path)  # For headers that include each other.
            text = self._texts[path]
            included = [self._read(name) for name in included_in(text) if name in self._texts]
            self._macros[path] = Macros(path, included, self._lengths.texts)
            for name, (type_, line) in declared_types(text, self._macros[path], self._types.__contains__).items():
                before = self._types.get(name, type_)
                self._types[name] = type_ if before == type_ else either((before, type_), f"{path}:{line}")
                self._places[name] = path, line
        return self._macros[path]

    def extent(self, name: str, pointer: int = 8) -> Extent:
        """Of a structure, with pointers of ``pointer`` bytes. Raises TargetError for one that is not understood."""
        self._pointer = pointer
        return self._of(Named(name), name)

    def resolved(self, type_: CType) -> CType:
        """The type that a name has in the end; other types, and names that are not defined, as they are.

        Raises TargetError if it is a structure that is not understood.
        """
        seen: set[str] = set()
        known = ""
        while isinstance(type_, Named) and type_.name not in seen:
            seen.add(type_.name)
            known = self._known_as(type_.name)
            type_ = self._types.get(known, type_)
        if isinstance(type_, NotUnderstood):
            inside = f" in `{known}`" if known else ""
            place = f"{self.path(known)}:{type_.line}" if known in self._places else self._place
            raise TargetError(
                f"{place}: `{type_.part}`{inside} is not understood\n  help: declare each member as in `double level;`"
            )
        return type_

    def lacks(self, name: str, member: str) -> bool:
        """Whether a structure that is defined has no member of this name, also not in one inside without a name."""
        found = self._types.get(self._known_as(name))
        alternatives = found.types if isinstance(found, Either) else (found,)
        return all(isinstance(one, Structure) and member not in _members(one) for one in alternatives)

    def known_as(self, name: str) -> str:
        """The name with which a structure was defined; the same for all names of its type."""
        known = self._known_as(name)
        seen: set[str] = set()
        while isinstance(inside := self._types.get(known), Named) and known not in seen:
            seen.add(known)
            known = self._known_as(inside.name)
        return known

    def path(self, name: str) -> str:
        """Of the header that defines a type."""
        return self._places.get(self._known_as(name), ("a header", 0))[0]

    def _count(self, name: str, length: str) -> int:
        """The number of elements of an array called ``name``. Raises TargetError for one that is not understood."""
        number = self._lengths.value(length)
        if number is None:
            raise TargetError(
                f"{self._place}: the number of elements of `{name}[{length}]` is not understood\n"
                "  help: write a number, or a constant that is computed from numbers"
            )
        return number

    @property
    def _place(self) -> str:
        """Of what is computed."""
        return f"{self._within[-1][0]}:{self._within[-1][1]}" if self._within else "a header"

    def _known_as(self, name: str) -> str:
        return name if name in self._types else f"struct {name}"

    def _size_of(self, type_name: str) -> int:
        return self._of(type_named(type_name), type_name).size

    def _of(self, type_: CType, name: str) -> Extent:
        """Of what is called ``name``."""
        match type_:
            case Named(name=known):
                key = known, self._pointer
                if known in self._computed:
                    raise TargetError(
                        f"{self._place}: `{known}` may contain itself, so it is not known how large it is\n"
                        "  help: let it have a pointer, and define each type once, without a condition"
                    )
                if key not in self._known:
                    self._computed.append(known)
                    around = self._within[-1] if self._within else ("a header", 0)
                    self._within.append(self._places.get(self._known_as(known), around))
                    self._known[key] = self._of_named(type_, name)
                    self._within.pop()
                    self._computed.pop()
                return self._known[key]
            case Pointer() | Function():
                return Extent(self._pointer, self._pointer)
            case Array(element=element, length=length):
                each = self._of(element, name)
                return Extent(each.size * self._count(name, length), each.alignment)
            case Structure():
                return self._of_members(type_)
            case Either(types=types):
                extents = [self._of(one, name) for one in types]
                return Extent(max(one.size for one in extents), max(one.alignment for one in extents))
            case NotUnderstood():
                return self._of(self.resolved(type_), name)

    def _of_named(self, type_: Named, name: str) -> Extent:
        number = self._of_number(type_.name)
        if number is not None:
            return number
        found = self.resolved(type_)
        if not isinstance(found, Named):
            return self._of(found, name)
        number = self._of_number(found.name)
        if number is None:
            raise TargetError(
                f"{self._place}: `{found.name}`, the type of `{name}`, is not defined here or in a header beside it, "
                "so it is not known how large it is and what pointers it has\n"
                "  help: put its header beside this one, or keep a pointer to it"
            )
        return number

    def _of_number(self, name: str) -> Extent | None:
        part = self._scalar(name.replace("_Complex", "").strip())
        return None if part is None else Extent(2 * part if "_Complex" in name else part, part)

    def _scalar(self, name: str) -> int | None:
        """The bytes of a real number; None for another type."""
        if name in _AS_POINTERS:
            return self._pointer
        if name in _SCALARS:
            return _SCALARS[name]
        words = name.split()
        if "double" in words:
            return _LARGEST
        if not words or not _INTEGER.issuperset(words):
            return None
        if "char" in words:
            return 1
        if "short" in words:
            return 2
        return {0: 4, 1: self._pointer}.get(words.count("long"), 8)

    def _of_members(self, type_: Structure) -> Extent:
        end, largest, alignment = 0, 1, 1
        for member in type_.members:
            if self._within:
                self._within[-1] = self._within[-1][0], member.line
            extent = self._of(member.type, member.name)
            aligned = max(extent.alignment, *(self._aligned(text) for text in ("1", *member.alignment)))
            alignment = max(alignment, aligned)
            end = -(-end // aligned) * aligned + extent.size
            largest = max(largest, extent.size)
        alignment = max(alignment, *(self._aligned(text) for text in ("1", *type_.alignment)))
        whole = largest if type_.kind == "union" else end
        return Extent(-(-max(whole, 1) // alignment) * alignment, alignment)

    def _aligned(self, text: str) -> int:
        """What an alignment as it is written asks for: a number, or a type to be aligned like."""
        value = self._lengths.value(text)
        return self._of(type_named(text), text).alignment if value is None else max(value, 1)


def _members(type_: Structure) -> Iterator[str]:
    for member in type_.members:
        if not member.name and isinstance(member.type, Structure):
            yield from _members(member.type)
        yield member.name
