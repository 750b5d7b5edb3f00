"""The examples of C programs within others: each is built as its page says, and runs.

FreeRTOS, Zephyr and ROS 2 are small headers that declare what the examples use, with a double that runs the example's
loop in virtual time. POSIX and the emulated processors are the real ones.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.c_kernel.building import need, run

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "c"
DOUBLES = Path(__file__).parent / "c"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")


@pytest.fixture
def examples(tmp_path: Path) -> Path:
    """A copy of all examples."""
    return Path(shutil.copytree(EXAMPLES, tmp_path / "c"))


def compiled(example: Path) -> Path:
    """The package of the tank in an example, as its page makes it."""
    (page,) = example.glob("README.md")
    lines = page.read_text(encoding="utf-8").splitlines()
    (command,) = [line.split() for line in lines if line.startswith("    cspdiag")]
    program = (example / command[2]).resolve()
    target = example / command[-1]
    assert main([command[1], str(program), *command[3:-1], str(target)]) == 0
    return target / "tank"


def test_posix(examples: Path) -> None:
    need("cc", "make")
    example = examples / "posix"
    package = compiled(example)
    run("make", "-s", "-C", package, "CFLAGS=-O2 -DCSP_TRACE_HOOK=1", "tank.o")
    sources = ("main.c", package / "tank.o", "-lm", "-pthread")
    run("cc", "-std=c99", "-O2", *WARNINGS, f"-I{package}", *sources, "-o", "tank", cwd=example)
    lines = run(example / "tank", "100").splitlines()
    assert [line for line in lines if line.endswith("is safe")] == ["output 0 is safe", "output 1 is safe"]
    # A busy machine may be late by a period, which ends the run in another way.
    if not lines[-1].startswith("Timeout: a sample of Tank.level was overwritten"):
        assert lines[0] == "lamp on"
        assert lines[-1] == "ended by itself"
    # Ctrl-C ends it although the thread that would press the button sleeps for a minute.
    process = subprocess.Popen([example / "tank", "60000"], stdout=subprocess.PIPE, text=True)
    while len(os.listdir(f"/proc/{process.pid}/task")) < 2:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    stopped = process.communicate(timeout=30)[0].splitlines()
    assert stopped[:3] == ["output 0 is safe", "lamp off", "output 1 is safe"]
    assert stopped[3] == "stopped" or stopped[3].startswith("Timeout")


def test_freertos(examples: Path) -> None:
    need("cc", "make")
    example = examples / "freertos"
    package = compiled(example)
    run("make", "-s", "-C", package, "tank.o")
    includes = (f"-I{package}", f"-I{example}", f"-I{DOUBLES / 'freertos'}")
    sources = (example / "tank_task.c", DOUBLES / "freertos" / "double.c", package / "tank.o", "-lm")
    run("cc", "-std=c99", "-O1", *WARNINGS, *includes, *sources, "-o", example / "tank")
    assert run(example / "tank").splitlines() == [
        "task tank, 512 words, priority 3",
        "lamp on at 500 ms",
        "lamp off at 500 ms",
        "ended by itself after 50 samples, level 0.61, opening 0",
    ]
    assert run(example / "tank", "fault").splitlines()[1:] == ["lamp off at 300 ms", "halted, opening 0"]


def test_zephyr(examples: Path) -> None:
    need("cc")
    example = examples / "zephyr"
    package = compiled(example)
    module = package / "src"
    sources = [*sorted(module.rglob("*.c")), example / "src" / "main.c", DOUBLES / "zephyr" / "double.c"]
    includes = [f"-I{folder}" for folder in (module, *(path for path in module.rglob("*") if path.is_dir()))]
    doubles = (f"-I{example / 'src'}", f"-I{DOUBLES / 'zephyr'}")
    run("cc", "-std=c99", "-O1", *WARNINGS, *includes, *doubles, *sources, "-lm", "-o", example / "tank")
    assert run(example / "tank").splitlines() == [
        "lamp on at tick 50350",
        "lamp off at tick 50350",
        "ended by itself",
        "50 samples, level 0.61, opening 0, stack 2048",
    ]
    assert run(example / "tank", "fault").splitlines() == ["lamp off at tick 30123", "halted, reason 0, opening 0"]
    assert "CONFIG_TANK=y" in (example / "prj.conf").read_text(encoding="utf-8")
    assert "config TANK\n" in (package / "zephyr" / "Kconfig").read_text(encoding="utf-8")


def test_ros2(examples: Path) -> None:
    need("cmake", "g++")
    example = examples / "ros2"
    package = compiled(example)
    installed = f"-DCMAKE_INSTALL_PREFIX={example / 'install'}"
    run("cmake", "-S", package, "-B", package / "made", installed)
    run("cmake", "--build", package / "made", "--target", "install")
    packages = [f"-D{name}_DIR={DOUBLES / 'ros2' / 'cmake'}" for name in ("ament_cmake", "rclcpp", "std_msgs")]
    flags = f"-DCMAKE_CXX_FLAGS={' '.join(('-O1', *WARNINGS))}"
    run("cmake", "-S", example, "-B", example / "made", f"-DCMAKE_PREFIX_PATH={example / 'install'}", flags, *packages)
    run("cmake", "--build", example / "made")
    assert run(example / "made" / "tank_node").splitlines() == [
        "lamp 1 at 505 ms",
        "lamp 0 at 505 ms",
        "ended by itself",
        "level 0.61, opening 0",
    ]
    failed = subprocess.run([example / "made" / "tank_node", "executor"], capture_output=True, text=True, check=False)
    assert (failed.returncode, failed.stdout.splitlines()) == (1, ["lamp 0 at 505 ms", "the executor fails"])
    assert run(example / "made" / "tank_node", "publisher").splitlines()[:4] == [
        "an output is not published: the publisher fails",
        "an output is not published: the publisher fails",
        "lamp 0 at 400 ms",
        "stopped",
    ]
    # Ctrl-C: rclcpp's own handler would end communication before the safe values are published.
    assert run(example / "made" / "tank_node", "interrupt").splitlines() == [
        "lamp 0 at 510 ms",
        "stopped",
        "level 0.61, opening 0",
    ]


@pytest.mark.parametrize(
    ("processor", "compiler", "emulator"),
    [
        ("cortex-m0", "arm-none-eabi-gcc", "qemu-system-arm"),
        ("cortex-m4", "arm-none-eabi-gcc", "qemu-system-arm"),
        ("riscv32", "riscv64-unknown-elf-gcc", "qemu-system-riscv32"),
    ],
)
def test_without_an_operating_system(
    processor: str, compiler: str, emulator: str, examples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("make", compiler, emulator)
    example = examples / "bare_metal"
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    released = ["an output is safe", "lamp off", "an output is safe"]
    assert emulated(processor, emulator, example) == ["filling", "lamp on", *released, "ended by itself"]
    # A button that was pressed before the program began: its interrupt is pending.
    main = example / "main.c"
    main.write_text(main.read_text().replace("    board_start();\n", "    board_start();\n    board_press_button();\n"))
    assert emulated(processor, emulator, example) == ["lamp on", *released, "ended by itself"]


def emulated(processor: str, emulator: str, example: Path) -> list[str]:
    """What the example says, built anew."""
    run("make", "-s", processor, cwd=example)
    command = run("make", "-s", "-n", f"run-{processor}", cwd=example).splitlines()[-1].split()
    assert command[0] == emulator
    # Texts come by the serial line, or by semihosting on the other stream.
    return run("sh", "-c", f"{' '.join(command)} 2>&1", cwd=example).splitlines()
