"""How large the structures of a generated package are at most, from their definitions: no compiler is needed.

Sizes are those of machines with pointers of 64 bits; with shorter ones no structure is larger.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

_SCALARS = {
    "bool": 1, "char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4,
    "float": 4, "int": 4, "unsigned": 4, "int64_t": 8, "uint64_t": 8, "double": 8, "size_t": 8, "ptrdiff_t": 8,
    "intptr_t": 8, "uintptr_t": 8, "csp_word": 8,
}  # fmt: skip
_POINTER = 8
_BY_HAND = 256
"""The bytes that are reserved for a structure whose definition is not understood, because it is written by hand."""
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_DIRECTIVE = re.compile(r"^\s*#.*(?:\\\n.*)*$", re.MULTILINE)
_DEFINITION = re.compile(r"\b(?:typedef\s+)?(struct|union|enum)\s+(\w+)\s*\{")
_WORDS = re.compile(r"CSP_WORDS\((\d+)U?\)")


class Layout:
    """The structures that headers define, by name; ``struct x`` and ``x`` are the same."""

    def __init__(self, headers: Iterable[str], constants: Mapping[str, int]) -> None:
        self._constants = constants
        self._bodies: dict[str, tuple[str, str]] = {}
        self._known: dict[str, tuple[int, int]] = {}
        for text in headers:
            plain = _DIRECTIVE.sub("", _COMMENT.sub("", text))
            for found in _DEFINITION.finditer(plain):
                self._bodies[found[2]] = (found[1], _braces(plain, found.end()))

    def size(self, name: str) -> int:
        """The bytes of a structure."""
        return self._of(name)[0]

    def _of(self, name: str) -> tuple[int, int]:
        if name in _SCALARS:
            return _SCALARS[name], _SCALARS[name]
        if name not in self._known:
            kind, body = self._bodies.get(name, ("", ""))
            self._known[name] = (_BY_HAND, 8) if not kind else (4, 4) if kind == "enum" else self._members(kind, body)
        return self._known[name]

    def _members(self, kind: str, body: str) -> tuple[int, int]:
        end, largest, alignment = 0, 1, 1
        for declaration in _declarations(body):
            size, align = self._member(declaration)
            alignment = max(alignment, align)
            end = -(-end // align) * align + size
            largest = max(largest, size)
        whole = largest if kind == "union" else end
        return -(-max(whole, 1) // alignment) * alignment, alignment

    def _member(self, declaration: str) -> tuple[int, int]:
        inner = re.match(r"(struct|union)\s*\{", declaration)
        if inner:
            members = _braces(declaration, inner.end())
            size, align = self._members(inner[1], members)
            rest = declaration[inner.end() + len(members) :]
        else:
            rest = declaration
            words = re.findall(r"\w+", re.sub(r"\b(const|volatile|struct|union|enum|unsigned(?=\s+int))\b", "", rest))
            size, align = (_POINTER, _POINTER) if "*" in rest else self._of(words[0])
        count = 1
        for extent in re.findall(r"\[([^\]]*)\]", rest):
            count *= self._number(extent)
        return size * count, align

    def _number(self, extent: str) -> int:
        """The number of elements: a product of literals, constants and CSP_WORDS, which is largest for short words."""
        text = _WORDS.sub(lambda found: str(-(-int(found[1]) // 32)), extent)
        product = 1
        for factor in re.findall(r"\w+", text):
            number = re.fullmatch(r"(\d+)U?", factor)
            product *= int(number[1]) if number else self._constants[factor]
        return product


def _braces(text: str, start: int) -> str:
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
