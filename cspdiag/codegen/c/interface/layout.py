"""How large the structures of a generated package are at most, from their definitions: no compiler is needed.

Sizes are those of machines with pointers of 8 or of 4 bytes; with shorter pointers no structure is larger.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.lengths import Lengths
from cspdiag.codegen.shared.target_error import TargetError

_SCALARS = {
    "bool": 1, "char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4,
    "float": 4, "int64_t": 8, "uint64_t": 8, "double": 8,
}  # fmt: skip
_AS_POINTERS = frozenset({"size_t", "ptrdiff_t", "intptr_t", "uintptr_t", "csp_word"})
_BY_HAND = 256
"""The bytes that are reserved for a structure whose definition is not understood, because it is written by hand."""
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DIRECTIVE = re.compile(r"^\s*#.*(?:\\\n.*)*$", re.MULTILINE)
_DEFINITION = re.compile(r"\b(?:typedef\s+)?(struct|union|enum)\s+(\w+)\s*\{")
_ALIAS = re.compile(r"\btypedef\s+((?:\w+\s+)+?)(\w+)\s*;")
_INTEGER = frozenset({"signed", "unsigned", "char", "short", "int", "long"})
"""The words of which the names of C's own integers are made."""
_FUNCTION_POINTER = re.compile(r"\(\s*\*\s*(?:const\s+|volatile\s+)*(\w+)\s*\)")
_QUALIFIER = re.compile(r"\b(?:const|volatile)\b")


@record
class Member:
    """A member of a structure."""

    name: str
    type: str
    """As it is written, without qualifiers; empty if it is a structure or a union without a name."""
    is_pointer: bool
    extents: tuple[str, ...]
    """Of an array, as they are written."""
    kind: str = ""
    """`struct` or `union` without a name, and its members as text:"""
    body: str = ""


def without_comments(text: str) -> str:
    """The text of a header without its comments, each line where it was."""
    return _COMMENT.sub(lambda found: " " + "\n" * found[0].count("\n"), text)


def members_of(body: str) -> Iterator[Member]:
    """The members that are declared between the braces of a structure, one after the other."""
    return map(_member, _declarations(body))


def _member(declaration: str) -> Member:
    inner = re.match(r"(struct|union)\s*\{", declaration)
    kind = body = ""
    rest = declaration
    if inner:
        kind, body = inner[1], inside_braces(declaration, inner.end())
        rest = declaration[inner.end() + len(body) + 1 :]
    extents = tuple(re.findall(r"\[([^\]]*)\]", rest))
    plain = re.sub(r"\[[^\]]*\]|:\s*\d+\s*$", "", _QUALIFIER.sub("", rest)).strip()
    function = _FUNCTION_POINTER.search(rest)
    name = function[1] if function else re.findall(r"\w+", plain)[-1]
    type_name = " ".join(plain.removesuffix(name).split())
    return Member(name, "" if inner else type_name, "*" in plain, extents, kind, body)


class Layout:
    """The structures that headers define, by name; ``struct x`` and ``x`` are the same."""

    def __init__(self, headers: Iterable[str], constants: Mapping[str, int], pointer: int = 8) -> None:
        """``pointer``: the bytes of a pointer."""
        self._pointer = pointer
        self._lengths = Lengths(constants, self._of_type)
        self._aliases: dict[str, str] = {}
        self._bodies: dict[str, tuple[str, str]] = {}
        self._known: dict[str, tuple[int, int]] = {}
        for text in headers:
            uncommented = without_comments(text)
            self._lengths.add(uncommented)
            plain = _DIRECTIVE.sub("", uncommented)
            self._aliases |= {name: " ".join(type_name.split()) for type_name, name in _ALIAS.findall(plain)}
            for found in _DEFINITION.finditer(plain):
                self._bodies[found[2]] = (found[1], inside_braces(plain, found.end()))

    def definition(self, type_name: str) -> tuple[str, str]:
        """`struct`, `union` or `enum`, and what is between the braces; empty for other types, and unknown ones."""
        return self._bodies.get(type_name.rpartition(" ")[2], ("", ""))

    def size(self, name: str) -> int:
        """The bytes of a structure."""
        return self._of(name)[0]

    def count(self, member: Member) -> int:
        """The number of its elements. Raises TargetError for a length that is not understood."""
        product = 1
        for extent in member.extents:
            length = self._lengths.value(extent)
            if length is None:
                raise TargetError(
                    f"the number of elements of `{member.name}[{extent}]` in a header is not understood\n"
                    "  help: write a number, or a constant that is computed from numbers"
                )
            product *= length
        return product

    def _of_type(self, type_name: str) -> int:
        return self._pointer if "*" in type_name else self._of(_unqualified(type_name))[0]

    def _of(self, name: str) -> tuple[int, int]:
        scalar = self._pointer if name in _AS_POINTERS else _SCALARS.get(name)
        if scalar is None:
            scalar = self._integer(name.split())
        if scalar is not None:
            return scalar, scalar
        if name in self._aliases and name not in self._bodies:
            return self._of(_unqualified(self._aliases[name]))
        if name not in self._known:
            kind, body = self._bodies.get(name, ("", ""))
            self._known[name] = (_BY_HAND, 8) if not kind else (4, 4) if kind == "enum" else self._members(kind, body)
        return self._known[name]

    def _integer(self, words: list[str]) -> int | None:
        """The bytes of an integer of C; None for another type."""
        if not words or not _INTEGER.issuperset(words):
            return None
        if "char" in words:
            return 1
        if "short" in words:
            return 2
        return {0: 4, 1: self._pointer}.get(words.count("long"), 8)

    def _members(self, kind: str, body: str) -> tuple[int, int]:
        end, largest, alignment = 0, 1, 1
        for member in members_of(body):
            size, align = self._member(member)
            alignment = max(alignment, align)
            end = -(-end // align) * align + size
            largest = max(largest, size)
        whole = largest if kind == "union" else end
        return -(-max(whole, 1) // alignment) * alignment, alignment

    def _member(self, member: Member) -> tuple[int, int]:
        if member.kind:
            size, align = self._members(member.kind, member.body)
        elif member.is_pointer:
            size, align = self._pointer, self._pointer
        else:
            size, align = self._of(_unqualified(member.type))
        return size * self.count(member), align


def _unqualified(type_name: str) -> str:
    return re.sub(r"^(?:struct|union|enum) ", "", " ".join(_QUALIFIER.sub("", type_name).split()))


def inside_braces(text: str, start: int) -> str:
    """What is between the brace that ends at ``start`` and the one that closes it."""
    depth, at = 1, start
    while depth:
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        at += 1
    return text[start : at - 1]


def _declarations(body: str) -> Iterable[str]:
    """The declarations of members; those of ``a, b`` are separate."""
    depth, begun = 0, 0
    for at, character in enumerate(body):
        depth += {"{": 1, "}": -1}.get(character, 0)
        if character == ";" and depth == 0:
            text = body[begun:at].strip()
            begun = at + 1
            if text and "{" not in text and "(" not in text and "," in text:
                first, *others = text.split(",")
                yield first
                yield from (f"{first.split()[0]} {other}" for other in others)
            elif text:
                yield text
