"""The port for Cortex-M, also on a Cortex-M0: its clock, in waits that are short, and longer than its counter counts;
and differences and comparisons of doubles.

The emulator derives its clock from the number of instructions, so the run does not depend on the machine of the test.
"""

from __future__ import annotations

import math
import operator
import struct
from pathlib import Path

import pytest

from tests.c_kernel.building import HERE, need, run
from tests.c_kernel.test_cortex_m import FLAGS, LINKED, emulated
from tests.c_kernel.test_instances import package
from tests.support.compiling import compile_once

PLATFORM = ("csp_platform.c", "csp_port_cortex_m.c", "csp_port_cortex_m_startup.c")
ALL_OF_THE_COUNTER = "-DCSP_CORTEX_M_LONGEST=(1<<24)"
OF_THE_EMULATOR = "-DCSP_CORTEX_M_RESTART=1"


def firmware(folder: Path, processor: str, program: str, main: str, *options: str) -> Path:
    """A program with its main, by its step interface, for a processor."""
    need("arm-none-eabi-gcc", "qemu-system-arm")
    sources = [path for path in package(folder, str(HERE / "devices" / program), 0) if path.stem != "csp_run"]
    platform = [folder / "support" / name for name in PLATFORM if folder / "support" / name not in sources]
    image = folder / "program.elf"
    compile_once(
        *("arm-none-eabi-gcc", f"-mcpu={processor}", "-mthumb", *FLAGS, "-Werror", *options),
        *(f"-I{folder}", f"-I{folder / 'support'}", *sources, *platform, HERE / "cortex_m" / main),
        *(*LINKED, "-o", image),
    )
    return image


@pytest.mark.parametrize("processor", ["cortex-m3", "cortex-m0"])
@pytest.mark.parametrize("longest", [[], [ALL_OF_THE_COUNTER]], ids=["of 50 ms", "of 24 bits"])
def test_a_wait_ends_at_its_instant(processor: str, longest: list[str], tmp_path: Path) -> None:
    image = firmware(tmp_path, processor, "ticker.csp", "ticker.c", OF_THE_EMULATOR, *longest)
    found = {word: int(number) for word, _, number in (line.rpartition(" ") for line in emulated(image))}
    assert 90 <= found["shortest"] <= 100 <= found["longest"] <= 110
    assert abs(found["beats until"] - 200_000) <= 100
    assert abs(found["waited"] - 800_000) <= 100
    assert found["state"] == 3


def real_of(digits: str) -> float:
    (value,) = struct.unpack(">d", bytes.fromhex(digits))
    assert isinstance(value, float)
    return value


OPERATORS = {"=": operator.eq, "<": operator.lt, "l": operator.le, ">": operator.gt, "g": operator.ge}


@pytest.mark.parametrize("options", [[], ["-flto"]], ids=["by files", "whole"])
def test_doubles_on_a_cortex_m0(options: list[str], tmp_path: Path) -> None:
    """They are subtracted by the addition of libgcc, to the last bit, and compared without it."""
    image = firmware(tmp_path, "cortex-m0", "ticker.csp", "doubles.c", *options)
    functions = run("arm-none-eabi-nm", image).split()
    assert not {"__gedf2", "__ledf2", "__eqdf2", "__subdf3"} & set(functions)
    lines = [line.split() for line in emulated(image)]
    assert len(lines) == 14**2
    for left, right, difference, compared in lines:
        one, other = real_of(left), real_of(right)
        assert compared == "".join(sign for sign, holds in OPERATORS.items() if holds(one, other)) + ".", (left, right)
        expected = one - other
        if math.isnan(expected):
            assert math.isnan(real_of(difference))
        else:
            assert difference == struct.pack(">d", expected).hex(), (left, right)
