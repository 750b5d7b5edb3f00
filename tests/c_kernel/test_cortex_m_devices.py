"""A generated program with its own devices on an emulated board: events from a real interrupt, faults of the processor,
no heap.

The emulator derives its clock from the number of instructions, so the run does not depend on the machine of the test.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from tests.c_kernel.building import HERE, HOSTED, need, run
from tests.c_kernel.test_cortex_m import CLOCK, FLAGS, LINKED, MACHINE, PROCESSOR
from tests.conformance.sources import network_of, read
from tests.support.compiling import compile_once

BOTH = ["released drive", "released lamp"]


CORTEX_M0 = ("-mcpu=cortex-m0", "-mthumb")


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(tmp_path_factory.mktemp("board"), PROCESSOR)


@pytest.fixture(scope="module")
def of_cortex_m0(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(tmp_path_factory.mktemp("board_m0"), CORTEX_M0)


def compiled(folder: Path, processor: tuple[str, ...]) -> Path:
    """The objects of the machine for a processor."""
    need("arm-none-eabi-gcc", "qemu-system-arm")
    machine = network_of(read(str(HERE / "devices" / "machine.csp")))
    for path, text in pipeline.generate(machine, read, "c").items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    hosted = {*HOSTED, "csp_port_simulation.c", "csp_port_posix.c", "main_simulation.c"}
    sources = [
        file
        for file in sorted(folder.rglob("*.c"))
        if file.name not in hosted and not file.name.startswith("csp_port_board")
    ]
    compile_once("arm-none-eabi-gcc", *processor, *compiling(folder), "-c", *sources, cwd=folder)
    return folder


def compiling(folder: Path) -> tuple[str, ...]:
    return (*FLAGS, "-Werror", f"-I{folder}", f"-I{folder / 'support'}")


def image(package: Path, trouble: str, processor: tuple[str, ...] = PROCESSOR) -> Path:
    made = package / f"{trouble.replace(' ', '_')}.elf"
    source = HERE / "cortex_m" / "machine.c"
    definition = f'-DTROUBLE="{trouble}"'
    objects = sorted(package.glob("*.o"))
    compile_once(
        "arm-none-eabi-gcc", *processor, *compiling(package), definition, source, *objects, *LINKED, "-o", made
    )
    return made


def emulated(
    package: Path, trouble: str, *options: str, processor: tuple[str, ...] = PROCESSOR
) -> tuple[int, list[str]]:
    """The exit status of the emulator, and what arrived on the serial line."""
    command: list[str | Path] = [*MACHINE, *CLOCK, *options, "-kernel", image(package, trouble, processor)]
    completed = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    return completed.returncode, completed.stdout.splitlines()


def releases(lines: list[str]) -> list[str]:
    return [line for line in lines if line.startswith("released")]


def test_an_interrupt_delivers_an_event_to_a_sleeping_program(package: Path) -> None:
    status, lines = emulated(package, "pressed")
    assert status == 0
    assert lines[:5] == ["masked in between 1", "masked after 0", "lamp", *BOTH]
    assert int(lines[5].removeprefix("sampled ")) > 0
    assert lines[6:] == ["ending 0", "alive 1", "end"]


def test_an_event_input_is_polled(package: Path) -> None:
    _, lines = emulated(package, "polled")
    assert lines[2:-2] == ["lamp", *BOTH, "sampled 10", "ending 0"]


def test_a_network_that_is_built_again_runs_again(package: Path) -> None:
    _, lines = emulated(package, "twice")
    assert lines[2:-2] == ["lamp", *BOTH, "sampled 10", "ending 0"] * 2


def test_a_device_slower_than_its_period_misses_samples(package: Path) -> None:
    _, lines = emulated(package, "slow")
    assert releases(lines) == BOTH
    assert "ending 1" in lines
    assert any(line.startswith("Timeout: a sample of Machine.level was overwritten") for line in lines), lines


@pytest.mark.parametrize(
    "trouble",
    [
        *("fault", "undefined instruction", "unexpected interrupt", "fault in an interrupt", "fault in a safe value"),
        "fault in an interrupt and safe value is large",
        *("interrupt without a handler", "read overflows", "read overflows and safe value overflows"),
    ],
)
def test_a_fault_of_the_processor_releases_the_outputs(package: Path, trouble: str) -> None:
    status, lines = emulated(package, trouble)
    assert status == 1
    assert [line for line in lines[2:] if line] == BOTH


@pytest.mark.parametrize(
    ("trouble", "status"),
    [
        ("read exits", 0),
        ("read exits and safe value exits", 0),
        ("exit in an interrupt", 0),
        ("read aborts", 1),
        ("read asserts", 1),
    ],
)
def test_an_end_of_the_library_releases_the_outputs(package: Path, trouble: str, status: int) -> None:
    found, lines = emulated(package, trouble)
    assert found == status
    assert lines[2:] == BOTH


@pytest.mark.parametrize(
    ("trouble", "status"),
    [
        *(("fault", 1), ("fault in an interrupt", 1), ("fault in a safe value", 1), ("unexpected interrupt", 1)),
        *(("interrupt without a handler", 1), ("read exits", 0), ("exit in an interrupt", 0), ("read aborts", 1)),
        ("fault in an interrupt and safe value is large", 1),
    ],
)
def test_the_outputs_are_released_on_a_smaller_processor_too(of_cortex_m0: Path, trouble: str, status: int) -> None:
    found, lines = emulated(of_cortex_m0, trouble, processor=CORTEX_M0)
    assert found == status
    assert [line for line in lines[2:] if line] == BOTH


def test_an_interrupt_delivers_an_event_on_a_smaller_processor_too(of_cortex_m0: Path) -> None:
    status, lines = emulated(of_cortex_m0, "pressed", processor=CORTEX_M0)
    assert status == 0
    assert lines[2:5] == ["lamp", *BOTH]


def test_a_watchdog_is_kicked_by_a_program_that_continues(package: Path) -> None:
    _, lines = emulated(package, "polled and watchdog")
    assert lines[2:-2] == ["lamp", *BOTH, "sampled 10", "ending 0"]


def test_a_watchdog_that_warns_releases_the_outputs_of_one_that_hangs(package: Path) -> None:
    status, lines = emulated(package, "read hangs and watchdog")
    assert status == 1
    assert lines[2:] == BOTH


def test_a_watchdog_resets_the_board_where_a_safe_value_hangs(package: Path) -> None:
    _, lines = emulated(package, "polled, safe value hangs and watchdog", "-no-reboot")
    assert lines[2:] == ["lamp", *BOTH]


def test_firmware_has_no_heap(package: Path) -> None:
    symbols = run("arm-none-eabi-nm", image(package, "pressed")).split()
    assert any(symbol.endswith("csp_describe_error") for symbol in symbols)
    assert not {"malloc", "_malloc_r", "free", "_free_r", "sbrk", "_sbrk", "_sbrk_r", "snprintf", "strtod"} & {*symbols}


def test_without_a_debugger_the_program_continues(package: Path) -> None:
    """Writing for debuggers is then a fault of the processor, which is not a fault of the program."""
    board = ("qemu-system-arm", "-machine", "mps2-an385", "-nographic")
    command: list[str | Path] = [*board, *CLOCK, "-kernel", image(package, "fault")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline().strip() for _ in range(4)]
        process.kill()
    assert lines[2:] == BOTH


def superloop(folder: Path, program: str, main: str, *options: str, status: int = 0) -> list[str]:
    """What a superloop writes that includes nothing of the program but the header of its step interface."""
    need("arm-none-eabi-gcc", "qemu-system-arm")
    for path, text in pipeline.generate(network_of(read(program)), read, "c", 1).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    hosted = {*HOSTED, "csp_port_simulation.c", "csp_port_posix.c", "main_simulation.c"}
    left_out = ("_environment", "csp_port_board")
    sources = [file for file in sorted(folder.rglob("*.c")) if file.name not in hosted]
    sources = [file for file in sources if not any(part in file.name for part in left_out)]
    loop, made = HERE / "cortex_m" / main, folder / "superloop.elf"
    processor = options if any(option.startswith("-mcpu") for option in options) else (*PROCESSOR, *options)
    compile_once("arm-none-eabi-gcc", *processor, *compiling(folder), *sources, loop, *LINKED, "-o", made)
    command: list[str | Path] = [*MACHINE, *CLOCK, "-kernel", made]
    completed = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert completed.returncode == status, completed.stderr
    return completed.stdout.splitlines()


def test_no_event_of_an_interrupt_is_lost_unreported(tmp_path: Path) -> None:
    lines = superloop(tmp_path, "tests/c_kernel/devices/counter.csp", "superloop.c")
    assert lines == ["state 6", "overwritten some 1", "lost 0", "released 1"]


def test_an_interrupt_stops_the_spindle(tmp_path: Path) -> None:
    lines = superloop(tmp_path, "models/emergency/emergency.csp", "emergency.c")
    assert lines == ["brake off", "brake on", "halted", "brake is safe", "not halted", "ended by itself"]


@pytest.mark.parametrize(
    ("trouble", "processor"),
    [("bad pointer", PROCESSOR), ("undefined instruction", PROCESSOR), ("undefined instruction", CORTEX_M0)],
)
def test_a_fault_of_the_processor_in_a_law_releases_the_outputs_and_is_reported(
    trouble: str, processor: tuple[str, ...], tmp_path: Path
) -> None:
    options = (*processor, f'-DTROUBLE="{trouble}"')
    lines = superloop(tmp_path, "tests/c_kernel/devices/heating.csp", "heating.c", *options, status=1)
    safe, cause = ["power is safe", "lamp is safe"], "running: Heating.heater (last waited at heating.csp:2)"
    assert lines == [*safe, cause, "at an instruction"]


def test_a_value_of_a_law_that_is_not_finite_is_reported_before_the_outputs_are_released(tmp_path: Path) -> None:
    lines = superloop(tmp_path, "tests/c_kernel/devices/heating.csp", "heating.c", '-DTROUBLE="nan"')
    assert lines == ["failed", "fault", "Heating", "heater", "heating.csp:2", "power is safe", "lamp is safe", "ended"]
