"""The lengths of arrays in headers, also those by hand: integer constant expressions of C, without a compiler."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping, Sequence

from cspdiag.codegen.c.interface.directives import macros_of

_ENUM = re.compile(r"\benum\s*\w*\s*\{([^}]*)\}")
_SIZE_OF_TEXT = re.compile(r"\bsizeof\s*\(\s*\"((?:\\.|[^\"\\])*)\"\s*\)")
_SIZEOF = re.compile(r"\bsizeof\s*\(([^()]*)\)")
_WORDS = re.compile(r"\bCSP_WORDS\(([^()]*)\)")
_NAME = re.compile(r"\b[A-Za-z_]\w*\b")
_OCTAL = re.compile(r"(?<![\w.])0[0-7]+\b")
_CHARACTER = re.compile(r"'([^'\\])'")
_SUFFIX = re.compile(r"\b(0[xX][0-9a-fA-F]+|\d+)[uUlL]+\b")


def _shifted(number: int, bits: int) -> int:
    if bits >= 64:
        raise ValueError(bits)
    return number << bits


_BINARY: Mapping[type[ast.operator], Callable[[int, int], int]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod, ast.LShift: _shifted, ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_, ast.BitOr: operator.or_, ast.BitXor: operator.xor,
}  # fmt: skip
_DEEPEST = 32
"""Constants that are defined by others, one inside the other."""
_LONGEST = 10_000
"""Characters of an expression."""

_LIMITS = {"CHAR_BIT": 8} | {
    name: value
    for bits, name_of_c in ((8, "CHAR"), (16, "SHRT"), (32, "INT"))
    for name, value in (
        (f"INT{bits}_MAX", 2 ** (bits - 1) - 1),
        (f"UINT{bits}_MAX", 2**bits - 1),
        (f"{'S' * (bits == 8)}{name_of_c}_MAX", 2 ** (bits - 1) - 1),
        (f"U{name_of_c}_MAX", 2**bits - 1),
    )
}
"""Of `<limits.h>` and `<stdint.h>`."""


class Lengths:
    """The constants that headers define as macros or in enumerations. ``size`` gives the bytes of a type."""

    def __init__(self, constants: Mapping[str, int], size: Callable[[str], int]) -> None:
        self._texts = {name: [str(value)] for name, value in {**_LIMITS, **constants}.items()}
        self._size = size
        self._within: list[str] = []
        """The constants with several values that are computed, each for the one before."""

    @property
    def texts(self) -> Mapping[str, Sequence[str]]:
        """All that a constant is defined to be, in any header and under any condition."""
        return self._texts

    def add(self, text: str) -> None:
        """Add those of a header without comments."""
        for name, body in macros_of(text):
            self._define(name, body)
        for (body,) in ((found[1],) for found in _ENUM.finditer(text)):
            before = "-1"
            for entry in filter(None, (part.strip() for part in body.split(","))):
                name, _, value = (part.strip() for part in entry.partition("="))
                self._define(name, f"({value})" if value else f"({before} + 1)")
                before = name

    def _define(self, name: str, text: str) -> None:
        known = self._texts.setdefault(name, [])
        if text not in known:
            known.append(text)

    def _text(self, name: str) -> str:
        """Of a constant, the largest one; of another name, itself."""
        texts = self._texts.get(name, [name])
        if len(texts) == 1 or name in self._within:
            return texts[-1]
        self._within.append(name)
        values = [value for value in map(self.value, texts) if value is not None]
        self._within.pop()
        return str(max(values)) if values else texts[-1]

    def value(self, text: str) -> int | None:
        """Of an expression, the largest one with any definitions of its constants; None if it is not understood.
        CSP_WORDS is that of words of 32 bits, the largest.
        """
        for _ in range(_DEEPEST):
            before, text = text, _SIZE_OF_TEXT.sub(_size_of_text, _NAME.sub(lambda found: self._text(found[0]), text))
            if text == before:
                break
            if len(text) > _LONGEST:
                return None
        plain = _WORDS.sub(r"((\1 + 31) / 32)", _SUFFIX.sub(r"\1", text))
        plain = _OCTAL.sub(lambda found: str(int(found[0], 8)), plain)
        plain = _CHARACTER.sub(lambda found: str(ord(found[1])), plain)
        plain = _SIZEOF.sub(lambda found: str(self._size(found[1].strip())), plain).replace("/", "//")
        try:
            return _computed(ast.parse(plain.strip(), mode="eval").body)
        except (SyntaxError, ValueError, ArithmeticError):
            return None


def _size_of_text(found: re.Match[str]) -> str:
    """At most: what is written with a backslash is shorter."""
    return str(len(found[1].encode()) + 1)


def _computed(node: ast.expr) -> int:
    match node:
        case ast.Constant(value=int() as number):
            return number
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_computed(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _BINARY[type(op)](_computed(left), _computed(right))
    raise ValueError(ast.dump(node))
