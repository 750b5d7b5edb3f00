"""Where the preprocessor decides whether a struct by hand has a pointer, its state cannot be saved."""

from __future__ import annotations

import pytest

from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.interface.pointers import pointer_files
from cspdiag.codegen.shared.target_error import TargetError

HEADER = """\
#ifndef NETWORK_H
#define NETWORK_H
#include <stdint.h>
#include "real.h"
#include "other.h"
{before}
struct network {{
    int *first;
    {members}
}};
#endif
"""


def either(small: str, other: str) -> str:
    return f"#ifdef SMALL\n{small}\n#else\n{other}\n#endif"


REFUSED = {
    "types": (either("typedef intptr_t handle;", "typedef void *handle;"), "handle h;", "network.h:6"),
    "types the other way": (either("typedef void *handle;", "typedef intptr_t handle;"), "handle h;", "network.h:6"),
    "one": ("#ifdef SMALL\ntypedef void *handle;\n#endif", "handle h;", "network.h:6"),
    "structs": (either("struct h { int64_t a; };", "struct h { void *a; };"), "struct h h[2];", "network.h:6"),
    "behind a type": (either("typedef int t;", "typedef int *t;") + "\ntypedef t own[3];", "own h;", "network.h:6"),
    "inside a struct": (either("typedef int t;", "typedef int *t;"), "struct { int a; struct { t b; } c; } d[2];", "b"),
    "macros": (either("#define T int", "#define T int *"), "T t;", "network.h:7"),
    "macro of a macro": (either("#define T int", "#define T int *") + "\n#define U T", "int a; U t;", "network.h:7"),
    "macro in a type": (either("#define T int", "#define T int *") + "\ntypedef T t;", "t a;", "network.h:7"),
    "default": ("#ifndef T\n#define T int *\n#endif", "T t;", "network.h:7"),
    "members": (either("#define MORE int *p; int a;", "#define MORE"), "MORE int b;", "`p`"),
    "declarators": (either("#define STAR *", "#define STAR"), "int STAR p;", "network.h:7"),
    "kind": (either("#define KIND union", "#define KIND struct"), "KIND { int *p; int *q; } b;", "network.h:7"),
    "again": ("#define T int *\n#define T int", "T t;", "network.h:6"),
    "later": (
        "#define T int\nstruct a { T t; };\n#ifdef LARGE\n#undef T\n#define T int *\n#endif",
        "T t;",
        "network.h:10",
    ),
    "or a type": ("typedef int *handle;\n#ifdef SMALL\n#define handle int\n#endif", "handle h;", "network.h:8"),
    "no longer": ("typedef int *t;\n#define t int\n#ifdef SMALL\n#undef t\n#endif", "t a;", "network.h:7"),
    "inside": ("#define T int", "T a;\n#undef T\n#define T int *\nT b;", "network.h:6"),
    "in a declaration": ("", "int\n#ifdef SMALL\n*\n#endif\np;", "network.h:10"),
    "in a type": ("typedef int\n#ifdef SMALL\n*\n#endif\nhandle;", "handle h;", "network.h:7"),
    "two headers": ("typedef struct { int *p; } two;", "two t;", "network.h:6"),
    "an includer": ("", "struct sub s;", "real.h:5"),
    "not understood": (either("typedef FIELD(x) handle;", "typedef int handle;"), "handle h;", "handle"),
    "arguments": ("#define T(type) type *", "int a;\n    T(int) p;", "network.h:10: `T(int) p` in `struct network`"),
    "a branch": ("#if 0\n#elif SMALL\ntypedef int *handle;\n#else\ntypedef int handle;\n#endif", "handle h;", ":7"),
}


def rows(before: str, members: str) -> str:
    """The rows of the table for a header."""
    headers = {
        "network.h": HEADER.format(before=before, members=members),
        "real.h": "#pragma once\n#define OTHER double\n#ifndef REAL\n#define KEPT\n#define REAL double\n#endif\n"
        "struct sub { REAL level; };\n",
        "other.h": "#pragma once\ntypedef struct { int number; } two;\n#define REAL double *\n",
    }
    if "struct sub" not in members:
        headers["other.h"] = headers["other.h"].replace("double *", "float")
    layout = Layout(headers, {})
    layout.extent("struct network")
    return pointer_files(layout, [])["network_pointers.c"]


@pytest.mark.parametrize(("before", "members", "shown"), REFUSED.values(), ids=REFUSED)
def test_a_pointer_that_depends_on_the_preprocessor_is_refused(before: str, members: str, shown: str) -> None:
    with pytest.raises(TargetError) as refused:
        rows(before, members)
    assert shown in str(refused.value)
    assert "help: " in str(refused.value)


ACCEPTED = {
    "guarded type": ("#ifndef H_DEFINED\n#define H_DEFINED\ntypedef void *h_t;\n#endif", "h_t h;", 1),
    "limits": ("#include <limits.h>", "int *p[CHAR_BIT]; char c[UINT8_MAX + 1];", 1),
    "types": (either("typedef int32_t count;", "typedef struct { int64_t a[2]; } count;"), "count c[2];", 0),
    "real": (either("#define T float", "#define T double"), "T level, *levels; struct { T a; T *b; } c[2];", 3),
    "default": ("#ifndef T\n#define T double\n#endif", "T level;", 0),
    "default of elements": ("#ifndef T\n#define T double\n#endif", "T *levels, level;", 1),
    "other header": ("", "REAL level; OTHER other;", 0),
    "includer": ("", "struct own { REAL level; } s;", 0),
    "packed": (
        either("#define P __attribute__((packed))", "#define P") + "\nstruct P a { int *p; };",
        "struct a a;",
        2,
    ),
    "declspec": (either("#define P __declspec(align(8))", "#define P") + "\nstruct P a { int *p; };", "struct a a;", 2),
    "maybe packed": (
        "#ifdef __GNUC__\n#define P __attribute__((packed))\n#endif\nstruct P a { int *p; };",
        "int b;",
        0,
    ),
    "qualifier": ("#ifndef RESTRICT\n#define RESTRICT restrict\n#endif", "int *RESTRICT p;", 1),
    "lengths": (either("#define N 2", "#define N 4"), "int *p[N]; struct { int *q; } z[N];", 3),
    "pointers to it": (either("struct h { int64_t a; };", "struct h { void *a; };"), "struct h *h;", 1),
    "members": (either("#define MORE int a; int more[2];", "#define MORE"), "MORE int *b; MORE", 1),
    "never": ("#if 0\nstruct a { int *p; };\n#else\nstruct a { int p; };\n#endif", "struct a a; int *q;", 1),
    "in C++": ('#ifdef __cplusplus\nextern "C" {\n#endif\ntypedef int *p;', "p q;", 1),
    "undefined": ("#define T int\n#undef T\n#define T int *", "T p;", 1),
    "the same": ("#define T int *\n#define T int *\ntypedef T t;\ntypedef int *t;", "T p; t q;", 2),
    "a comment in a macro": ("#define STAR /* a\ncomment */ *", "int STAR p;", 1),
    "a continued comment": ("// int *p; \\\ntypedef int *t;\ntypedef double t;", "t a;", 0),
    "continued": ("", "int \\\n *p;", 1),
    "text": ('#define NAME "a{b*; // \\""', "char name[sizeof(NAME)]; int *q;", 1),
    "macro of a member": ("", "struct { int *low; } parts;\n#define low_ parts.low\nint low;", 1),
    "own name": ("#define first first", "int *p;", 1),
}


@pytest.mark.parametrize(("before", "members", "more"), ACCEPTED.values(), ids=ACCEPTED)
def test_other_conditions_are_no_matter(before: str, members: str, more: int) -> None:
    found = rows(before, members)
    assert found.count("offsetof(") - found.count("- offsetof(") == 1 + more, found
