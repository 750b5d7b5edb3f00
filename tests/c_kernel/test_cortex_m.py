"""The kernel on an emulated microcontroller: words of 32 bits, and no operating system.

A generated program with its simulated plant runs against the clock of the emulation, and its trace is that of the
reference. The emulator derives its clock from the number of instructions, so the run does not depend on the machine of
the test.
"""

from __future__ import annotations

import struct
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.network.ir.network import Network
from cspdiag.semantics.trace import Communication
from tests.c_kernel.building import HERE, HOSTED, PROGRAMS, SCENARIOS, SUPPORT, kernel_files, need
from tests.conformance.sources import network_of, read
from tests.conformance.targets import GeneratedPython
from tests.conformance.traces import compare
from tests.support.compiling import compile_once

UNTIL = 3_000_500_000
"""Nanoseconds, between two ticks: by then both joints of JIWY have found their end stops."""

PROCESSOR = ("-mcpu=cortex-m3", "-mthumb")
LINKED = ("-nostartfiles", "--specs=nosys.specs", "-Wl,--gc-sections", "-T", SUPPORT / "csp_port_cortex_m.ld", "-lm")
FLAGS = ("-std=c99", "-Os", "-Wall", "-Wextra", "-ffp-contract=off", "-ffunction-sections", "-fdata-sections")
MACHINE = ("qemu-system-arm", "-machine", "mps2-an385", "-nographic", "-semihosting-config", "enable=on,target=native")
CLOCK = ("-icount", "shift=3,sleep=off")
"""Eight nanoseconds per instruction; sleeping takes no time on the host."""


def firmware(network: Network, level: int, folder: Path, *options: str) -> Path:
    """The program of a network in its first environment, to be loaded by the emulator."""
    files = pipeline.generate(network, read, "c", level, traced=True)
    for path, text in files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    hosted = {*HOSTED, "csp_port_simulation.c", "csp_port_posix.c", "main_simulation.c"}
    sources = [
        file
        for file in sorted(folder.rglob("*.c"))
        if file.name not in hosted and not file.name.startswith("csp_port_board")
    ]
    environment = f"{network.environments[0].name.lower()}_environment"
    definitions = (
        *("-DCSP_TRACE=1", f'-DENVIRONMENT_HEADER="{environment}.h"', f"-DENVIRONMENT={environment}"),
        *(f"-DDRIVERS={environment}_drivers", f"-DDURATION=INT64_C({UNTIL})"),
    )
    includes = (f"-I{folder}", f"-I{folder / 'support'}")
    image = folder / "program.elf"
    compile_once(
        *("arm-none-eabi-gcc", *PROCESSOR, *FLAGS, *options, *definitions, *includes),
        *(*sources, HERE / "cortex_m" / "main.c"),
        *LINKED,
        *("-o", image),
    )
    return image


def emulated(image: Path) -> list[str]:
    """What the program writes."""
    completed = subprocess.run(
        [*MACHINE, *CLOCK, "-kernel", image], capture_output=True, text=True, timeout=120, check=False
    )
    written = completed.stdout + completed.stderr
    assert completed.returncode == 0, written[-1000:]
    return written.splitlines()


def bits(value: object) -> int:
    """The bytes of a value in memory, as a number."""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return int.from_bytes(struct.pack("<d", value), "little")
    assert isinstance(value, int)
    return value & (2**64 - 1)


@pytest.mark.parametrize(("level", "options"), [(0, ()), (0, ("-flto",)), (1, ("-flto",))])
def test_jiwy_on_a_microcontroller(level: int, options: tuple[str, ...], tmp_path: Path) -> None:
    need("arm-none-eabi-gcc", "qemu-system-arm")
    network = network_of(read("models/jiwy/jiwy.csp"))
    image = firmware(network, level, tmp_path, *options)
    lines = [line.split() for line in emulated(image)]
    records = [line for line in lines if line[0].isdigit()]
    trace = [Communication(int(time), name, int(number)) for time, name, number in records]
    reference = GeneratedPython(level=0).run(network, None, UNTIL).trace
    expected = [communication._replace(value=bits(communication.value)) for communication in reference]
    external = {communication.channel for communication in expected}
    assert compare(trace, expected, external) is None
    assert [line[0] for line in lines[-3:]] == ["release", "release", "ended"]


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The kernel in virtual time, for the microcontroller."""
    need("arm-none-eabi-gcc", "qemu-system-arm")
    folder = tmp_path_factory.mktemp("cortex_m")
    sources = [
        *kernel_files(),
        SUPPORT / "csp_port_cortex_m_startup.c",
        HERE / "script.c",
        HERE / "cortex_m" / "console.c",
    ]
    compile_once("arm-none-eabi-gcc", *PROCESSOR, *FLAGS, *SCENARIOS, f"-I{SUPPORT}", "-c", *sources, cwd=folder)
    return folder


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_scenario_on_a_microcontroller(objects: Path, program: Path) -> None:
    image = objects / f"{program.stem}.elf"
    includes = (f"-I{SUPPORT}", f"-I{HERE}")
    compile_once(
        "arm-none-eabi-gcc",
        *PROCESSOR,
        *FLAGS,
        *SCENARIOS,
        *includes,
        program,
        *objects.glob("*.o"),
        *LINKED,
        "-o",
        image,
    )
    assert emulated(image) == program.with_suffix(".txt").read_text().splitlines()
