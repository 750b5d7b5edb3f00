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
"""


@pytest.mark.parametrize(("compiler", "pointer"), [("gcc", 8), ("clang", 8), ("arm-none-eabi-gcc", 4)])
def test_sizes_are_those_of_compilers(compiler: str, pointer: int, tmp_path: Path) -> None:
    need(compiler, "nm")
    source = tmp_path / "sizes.c"
    names = ["filter", "struct inner", "struct law"]
    source.write_text(HEADER + "".join(f"char {name.split()[-1]}_size[sizeof({name})];\n" for name in names))
    subprocess.run([compiler, "-std=c99", "-c", source, "-o", tmp_path / "sizes.o"], check=True)
    listed = subprocess.run(["nm", "-P", tmp_path / "sizes.o"], check=True, capture_output=True, text=True).stdout
    expected = {row.split()[0]: int(row.split()[3], 16) for row in listed.splitlines() if "_size" in row}
    layout = Layout([HEADER], {}, pointer)
    assert {f"{name.split()[-1]}_size": layout.size(name.split()[-1]) for name in names} == expected


@pytest.mark.parametrize("length", ["strlen(NAME)", "UNKNOWN", "COUNT / 0", "a ? 1 : 2", "SELF", "MANY", "1 << 99"])
def test_a_length_that_is_not_understood_is_refused(length: str) -> None:
    text = f"#define SELF (SELF + 1)\n#define MANY MANY + MANY\nstruct law {{ double taps[{length}]; }};"
    with pytest.raises(TargetError, match="taps") as refused:
        Layout([text], {}).size("law")
    assert length in str(refused.value)
