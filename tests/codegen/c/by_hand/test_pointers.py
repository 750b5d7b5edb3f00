"""The tables of pointers in structures by hand, against where compilers have them."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest

from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.interface.pointers import pointer_files
from tests.c_kernel.building import STRICT, need
from tests.codegen.c.by_hand.random_structs import Structs

SUPPORT = Path(__file__).parents[4] / "templates" / "c" / "support"

HEADER = """\
#ifndef NETWORK_H
#define NETWORK_H
#include <stdint.h>
#include <stddef.h>
void csp_advance(void);
typedef struct { int *p; } item, items[4];
struct item { int number; int *behind; };
struct pair { char kind; const char *text; };
typedef struct pair *pairs[2];
typedef int *(*finder)(int, int **);
#define N 2
struct first { int *p[N]; intptr_t numbers[2]; };
#undef N
#define N 4
struct second { int *p[N]; intptr_t number; };
#undef N
#ifdef SMALL
#define ROOM 2
#else
#define ROOM 5
#endif
#define HALF(x) ((x) / 2)
struct network {
    struct first first;
    struct second second[2];
    items w[2];
    item alone;
    struct item tagged[2];
    struct { char kind; int *p, *r[2]; intptr_t number; } x[2][3];
    struct { int *q; } z[ROOM];
    struct { double *p; } slot[sizeof(struct pair) / 4], words[sizeof(void *)];
    struct { intptr_t number; struct { int *q; struct { int *p; int n; } y[2]; } x[3], one; } nested[HALF(5)];
    intptr_t numbers[3];
    int *none[0];
    struct { int *q; } nothing[0];
    pairs pairs[3];
    finder finders[2][3], find;
    struct { int *a; } members[2];
    struct members { int *q; } more_members;
    union { int *one; char *other; } either[3];
    union { double real; uint64_t whole; } number[3];
    struct { struct { int *p; }; int n; } inside[2];
    int *last;
};
#endif
"""
POINTERS = (
    "first.p", "second[].p", "w[][].p", "alone.p", "tagged[].behind", "x[][].p", "x[][].r", "z[].q", "slot[].p",
    "words[].p", "nested[].x[].q", "nested[].x[].y[].p", "nested[].one.q", "nested[].one.y[].p", "pairs", "finders",
    "find", "members[].a", "more_members.q", "either[].one", "inside[].p", "last",
)  # fmt: skip
"""With `[]` in place of all elements."""


def marked(path: str) -> str:
    """Statements of C that mark the words of the parts at a path."""
    first, *rest = path.split("[]")
    loops = ""
    for depth, after in enumerate(rest):
        loops += f"for (size_t i{depth} = 0U; i{depth} < COUNT({first}); i{depth}++) "
        first += f"[i{depth}]{after}"
    return f"{loops}MARK({first});\n"


def visited(folder: Path, header: str, pointers: Iterable[str], compiler: str, *options: str) -> None:
    """Compile a program that compares the words that are converted in ``struct network`` with those that the
    compiler has for its ``pointers``.
    """
    for name, text in {**pointer_files(Layout({"network.h": header}, {}), []), "network.h": header}.items():
        (folder / name).write_text(text)
    (folder / "main.c").write_text(MAIN.replace("TRUTH", "    ".join(map(marked, pointers))))
    sources = ["main.c", "network_pointers.c", str(SUPPORT / "csp_saved.c")]
    flags = [flag for flag in STRICT if flag != "-Wpedantic"]  # ISO C has no arrays without elements.
    command = [compiler, *flags, "-O1", "-I.", f"-I{SUPPORT}", *options, *sources]
    subprocess.run(command, cwd=folder, check=True, timeout=60)


@pytest.mark.parametrize("compiler", ["gcc", "clang", "arm-none-eabi-gcc"])
@pytest.mark.parametrize("option", ["-DSMALL", "-DLARGE"])
def test_pointers_are_where_compilers_have_them(compiler: str, option: str, tmp_path: Path) -> None:
    need(compiler)
    if compiler.startswith("arm"):
        visited(tmp_path, HEADER, POINTERS, compiler, option, "-mcpu=cortex-m3", "-mthumb", "-c")
        return
    visited(tmp_path, HEADER, POINTERS, compiler, option, "-fsanitize=address,undefined", "-o", "visits")
    done = subprocess.run([tmp_path / "visits"], capture_output=True, text=True, check=False, timeout=10)
    assert (done.stdout, done.stderr) == ("", "")


def test_pointers_of_random_structs_are_where_a_compiler_has_them(tmp_path: Path) -> None:
    need("gcc")
    structs = Structs(20, 60)
    visited(tmp_path, structs.header, structs.paths, "gcc", "-O0", "-o", "visits")
    assert subprocess.run([tmp_path / "visits"], capture_output=True, check=True, timeout=10).stdout == b""
    assert len(structs.paths) > 150


MAIN = r"""
#include "network_pointers.h"
#include "network.h"
#include <stdio.h>
#include <string.h>
void csp_advance(void) {}
static union { struct network network; uintptr_t words[sizeof(struct network) / sizeof(uintptr_t)]; } saved, is_pointer;
/* Marks all words of a part, which may be constant. */
#define MARK(part) (void)memset((void *)(uintptr_t)&is_pointer.network.part, 1, sizeof is_pointer.network.part)
#define COUNT(part) (sizeof is_pointer.network.part / sizeof is_pointer.network.part[0])
int main(void)
{
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    const csp_saved_places places = {&saved, 1U, &saved};
    TRUTH
    for (size_t at = 0U; at < sizeof saved.words / sizeof saved.words[0]; at++) {
        saved.words[at] = ((uintptr_t)at * 2U) + 1U;
    }
    csp_save_pointers(&saved, &network_pointers, visits, places);
    for (size_t at = 0U; at < sizeof saved.words / sizeof saved.words[0]; at++) {
        const int converted = saved.words[at] != (((uintptr_t)at * 2U) + 1U);
        if (converted != (is_pointer.words[at] != 0U)) {
            (void)printf("%s: word %u\n", converted ? "no pointer" : "not found", (unsigned)at);
        }
    }
    return 0;
}
"""
