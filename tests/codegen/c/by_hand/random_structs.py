"""Random structures in C, and where their pointers are."""

from __future__ import annotations

from itertools import count
from random import Random

BEFORE = """\
#ifndef NETWORK_H
#define NETWORK_H
#include <stdint.h>
#include <stddef.h>
#define N 2
#define HALF(x) ((x) / 2)
enum { K = N };
struct pair { char kind; const char *text; };
typedef struct opaque opaque;
void csp_advance(void);
"""
LENGTHS = ("1", "3", "N", "N + 1", "sizeof(int *) / 2", "sizeof(struct pair) / 4", "K", "HALF(4)", "(N > 1) ? 2 : 3")
POINTERS = (
    "int *{}", "const char *const {}", "struct pair *{}", "void *restrict {}", "int (*{})(int, char *)",
    "double (*{})[3]", "int **{}", "opaque *{}", "char *volatile {}",
)  # fmt: skip
NUMBERS = (
    "char {}",
    "int16_t {}",
    "intptr_t {}",
    "double {}",
    "unsigned long long {}",
    "union {{ double a; int b; }} {}",
)
Declared = tuple[str, list[str]]
"""A type with `{}` in place of the name, and the paths from it to its pointers, with `[]` in place of all elements."""


class Structs:
    """A header with ``struct network``, and the paths to its pointers."""

    def __init__(self, seed: int, members: int) -> None:
        self._random = Random(seed)
        self._numbers = count()
        self._types: list[str] = []
        structure, self.paths = self._structure(4, "network", members)
        self.header = "\n".join([BEFORE, *self._types, structure.format("") + ";", "#endif", ""])
        self.paths = [path.removeprefix(".") for path in self.paths]

    def _name(self, kind: str) -> str:
        return f"{kind}{next(self._numbers)}"

    def _named(self, declared: Declared, name: str, dots: str = "") -> Declared:
        """With a name, and perhaps as an array."""
        type_, paths = declared
        lengths = [self._random.choice(LENGTHS) for _ in range(self._random.choice([0, 0, 0, 1, 1, 2, 3]))]
        # An array of pointers is one part.
        inside = [f"{dots}{'[]' * len(lengths) if path else ''}{path}" for path in paths]
        return type_.format(name + "".join(f"[{length}]" for length in lengths)), inside

    def _structure(self, depth: int, tag: str, members: int) -> Declared:
        body: list[str] = []
        paths: list[str] = []
        for _ in range(members):
            if self._random.random() < 0.15:
                type_, found = self._structure(depth - 1, "", 2)
                type_ = type_.format("")
            else:
                name = self._name("m")
                type_, found = self._named(self._type(depth - 1), name, f".{name}")
            body.append(f"{type_};")
            paths += found
        return f"struct {tag} {{{{ {' '.join(body).replace('{', '{{').replace('}', '}}')} }}}} {{}}", paths

    def _type(self, depth: int) -> Declared:
        kind = (
            "pointer" if depth <= 0 else self._random.choice(["pointer", "number", "", "tag", "type", "union", "macro"])
        )
        match kind:
            case "pointer":
                return self._random.choice(POINTERS), [""]
            case "number":
                return self._random.choice(NUMBERS), []
            case "":
                return self._structure(depth, "", self._random.randint(1, 4))
            case "tag":
                return self._structure(depth, self._name("s"), self._random.randint(1, 4))
            case "type":
                name = self._name("t")
                type_, paths = self._named(self._type(depth - 1), name)
                self._types.append(f"typedef {type_};")
                return f"{name} {{}}", paths
            case "union":
                name = self._name("m")
                return f"union {{{{ int *{name}; char *{self._name('m')}; }}}} {{}}", [f".{name}"]
            case _:  # A macro.
                name = self._name("M")
                type_, paths = self._structure(depth, self._random.choice(["", self._name("s")]), 2)
                self._types.append(f"#define {name} {type_.format('')}")
                if "struct  {" not in type_:
                    self._types[-1:] = [f"{type_.format('')};", f"#define {name} {type_.partition(' {')[0]}"]
                return f"{name} {{}}", paths
