"""The sizes of structures in headers by hand, computed without a compiler, against those of compilers."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.shared.target_error import TargetError
from tests.c_kernel.building import need

HEADER = """\
#include <stdint.h>
#include <stddef.h>
#define COUNT 7
#define TWICE (2 * COUNT) /* of them */
#define LONG 0x10U + \\
    TWICE
typedef unsigned char byte;
enum { ROWS = 9, MORE, SIZE = sizeof(uint16_t) << 1, LAST };
typedef struct filter { double taps[COUNT]; float gains[ROWS]; } filter;
struct inner { const char *name; byte flags[LAST]; };
struct law {
    double level;
    filter filters[MORE];
    char text[sizeof(double) * 100];
    double products[2 * 8], shifted[1 << 6];
    unsigned char bytes[3000];
    byte pairs[TWICE][LONG / 3];
    signed char sign; short half; unsigned short halves[2]; long word; unsigned long long wide; int whole;
    const unsigned int numbers[3U];
    struct inner insides[COUNT % 4];
    double *pointers[COUNT - 2];
    size_t sizes[sizeof(struct filter)];
};
#define MANY double many[20]; \\
    byte few[3];
#define REAL float
#define EMPTY
typedef struct { REAL level; byte low; } conf_t, confs_t[4], *conf_ref;
typedef confs_t rooms[3];
typedef int (*callback)(void *, int[]);
typedef double vector[COUNT];
struct node { struct node *next, *const last; EMPTY conf_t here, *there, all[2]; };
struct declared {
    struct filter *first, second, *third[3], fourth;
    confs_t confs; rooms inside; conf_ref reference; callback called, calls[5]; vector v, *vs;
    union { double real; char raw[11]; };
    struct { int a; struct { byte b; uint16_t c; } inner[3]; };
    MANY
    int (*functions[20])(void); void (*one)(void *, int[], double (*)(int)); double (*row)[8];
    _Bool is_on;
    struct named { byte x[5]; } names[2]; union both { short half; long wide; } both;
    volatile float *volatile gains, gain; const char *const texts[2]; int const number; long unsigned int words;
    REAL reals[3]; struct node nodes[2];
    double matrix[2][3]; double _Complex turning; int (parenthesized), (*(pointed)), ((array)[3]);
    short z, y[2], *x; char last;
};
struct aligned { char a; char b __attribute__((aligned(32))); char c; };
typedef struct __attribute__((aligned(16))) { char a; } wide_t;
struct after { char a; wide_t wide; char b; } __attribute__((aligned(64)));
"""


@pytest.mark.parametrize(
    ("compiler", "pointer"), [("gcc", 8), ("clang", 8), ("arm-none-eabi-gcc", 4), ("riscv64-unknown-elf-gcc", 8)]
)
def test_sizes_are_those_of_compilers(compiler: str, pointer: int, tmp_path: Path) -> None:
    need(compiler, "nm")
    source = tmp_path / "sizes.c"
    names = ["filter", "struct inner", "struct law", "conf_t", "rooms", "struct node", "struct declared"]
    names += ["struct aligned", "wide_t", "struct after", "struct named", "union both"]
    source.write_text(HEADER + "".join(f"char {name.split()[-1]}_size[sizeof({name})];\n" for name in names))
    library = ["--specs=picolibc.specs"] if compiler.startswith("riscv") else []
    subprocess.run([compiler, *library, "-std=gnu11", "-c", source, "-o", tmp_path / "sizes.o"], check=True)
    listed = subprocess.run(["nm", "-P", tmp_path / "sizes.o"], check=True, capture_output=True, text=True).stdout
    expected = {row.split()[0]: int(row.split()[3], 16) for row in listed.splitlines() if "_size" in row}
    layout = Layout({"law.h": HEADER}, {})
    assert {f"{name.split()[-1]}_size": layout.extent(name, pointer).size for name in names} == expected


def test_an_enumeration_is_given_the_bytes_of_an_integer() -> None:
    text = "struct law { enum { OFF, ON = 2 } mode; enum later { LOW = 3 } other[LOW]; enum later last[ON]; };"
    assert Layout({"law.h": text}, {}).extent("law").size == 24


def test_each_bit_field_is_given_its_whole_type() -> None:
    assert (
        Layout({"law.h": "struct law { unsigned flags : 3, more : 4; unsigned : 5; char last : 2; };"}, {})
        .extent("law")
        .size
        == 16
    )


@pytest.mark.parametrize("length", ["strlen(NAME)", "UNKNOWN", "COUNT / 0", "a ? 1 : 2", "SELF", "MANY", "1 << 99"])
def test_a_length_that_is_not_understood_is_refused(length: str) -> None:
    text = f"#define SELF (SELF + 1)\n#define MANY MANY + MANY\nstruct law {{ double taps[{length}]; }};"
    with pytest.raises(TargetError, match="taps") as refused:
        Layout({"law.h": text}, {}).extent("law")
    assert length in str(refused.value)


@pytest.mark.parametrize(
    ("member", "shown"),
    [
        ("struct { FIELD(int, y); } z;", "FIELD(int, y)"),
        ("FIELD(double, x);", "FIELD(double, x)"),
        ("double 3;", "double 3"),
        ("LOOP", "LOOP"),
    ],
)
def test_a_member_that_is_not_understood_is_refused(member: str, shown: str) -> None:
    text = f"#define FIELD(type, name) type name\n#define LOOP LOOP LOOP\nstruct law {{ int a; {member} int b; }};"
    with pytest.raises(TargetError, match="law") as refused:
        Layout({"law.h": text}, {}).extent("law")
    assert shown in str(refused.value)


def test_a_type_that_is_not_understood_is_refused_where_it_is_used() -> None:
    text = "typedef struct { FIELD(double, x); } odd; struct law { odd one; }; struct other { int a; };"
    assert Layout({"law.h": text}, {}).extent("other").size == 4
    with pytest.raises(TargetError, match="FIELD"):
        Layout({"law.h": text}, {}).extent("law")


def test_what_is_not_used_need_not_be_understood() -> None:
    text = "#define SELF SELF +\nstruct other { FIELD(double, x); SELF y; };\ntypedef SELF z; struct law { int a; };"
    assert Layout({"law.h": text}, {}).extent("law").size == 4


@pytest.mark.parametrize(("length", "count"), [("010", 8), ("'z' - 'a'", 25), ("0x10 / sizeof(double[2])", 1)])
def test_lengths_are_those_of_c(length: str, count: int) -> None:
    assert Layout({"law.h": f"struct law {{ char text[{length}]; }};"}, {}).extent("law").size == count


@pytest.mark.parametrize(
    "before",
    [
        "#ifdef SMALL\n#define N 2\n#else\n#define N 5\n#endif",
        "#ifdef LARGE\n#define N (2 + 3)\n#else\n#define N 2\n#endif",
        "#define N 5\n#undef N\n#define N 2",
        "#ifndef M\n#define M 3\n#endif\n#define N (M + ONE)\n#define ONE 1\n#undef ONE\n#define ONE 2",
    ],
    ids=["other", "first", "earlier", "of others"],
)
def test_the_largest_definition_of_a_constant_counts(before: str) -> None:
    """So that the memory of an instance suffices with each of them."""
    assert Layout({"law.h": f"{before}\nstruct law {{ char text[N]; }};"}, {}).extent("law").size == 5


def test_the_largest_definition_of_a_type_counts() -> None:
    types = "#ifdef WIDE\ntypedef double real;\n#else\ntypedef float real;\n#endif\n"
    macros = "#ifndef WIDE\n#define INT int\n#else\n#define INT int64_t\n#endif\n"
    assert Layout({"law.h": f"{types}{macros}struct law {{ INT a; real b; }};"}, {}).extent("law").size == 16


@pytest.mark.parametrize(("text", "length"), [("NAME", 5), ('"{;"', 3), ("LONGER", 9)])
def test_texts_have_a_length(text: str, length: int) -> None:
    header = f'#define NAME "a{{b*"\n#define LONGER "// {{ \\" "\nstruct law {{ char text[sizeof({text})]; }};'
    assert Layout({"law.h": header}, {}).extent("law").size == length


def test_messages_have_the_line_of_the_member() -> None:
    headers = {
        "law.h": '#include "own.h"\n/* two\nlines */\nstruct law {\n    struct { own b;\n    int c; } d[2];\n};',
        "own.h": "#pragma once\n\ntypedef struct {\n    int first;\n    missing_t other;\n} own;",
    }
    with pytest.raises(TargetError) as refused:
        Layout(headers, {}).extent("law")
    assert str(refused.value).startswith("own.h:5: `missing_t`, the type of `other`")
    headers["own.h"] = headers["own.h"].replace("missing_t", "int")
    headers["law.h"] = headers["law.h"].replace("int c", "int \\\n c[LENGTH]")
    with pytest.raises(TargetError) as refused:
        Layout(headers, {}).extent("law")
    assert str(refused.value).startswith("law.h:6: the number of elements of `c[LENGTH]`")


def test_macros_hold_behind_their_definition_and_in_headers_that_include_them() -> None:
    headers = {
        "kernel.h": "struct kernel { char level; };",
        "law.h": """\
            #include "real.h"
            #include "kernel.h"
            struct law { REAL level; struct kernel kernel; };
            #define level kernel.level
            """,
        "real.h": "#define REAL double",
        "other.h": "typedef short REAL; struct other { REAL level; };",
    }
    layout = Layout(headers, {})
    assert [layout.extent(name).size for name in ("kernel", "law", "other")] == [1, 16, 2]


def test_a_struct_that_may_contain_itself_is_refused() -> None:
    one, two = "struct a { struct b b; };", "struct b { struct a a; };"
    other = "struct a { int x; };\nstruct b { int x; };"
    text = f"#ifdef ONE\n{one}\n#elif defined(TWO)\n{two}\n#else\n{other}\n#endif\nstruct law {{ struct a a; }};"
    with pytest.raises(TargetError, match="`struct a` may contain itself"):
        Layout({"law.h": text}, {}).extent("law")
