"""What the work of the kernel's operations grows with, as the table in docs/c.md says: counted in basic blocks.

That catching up does not grow with the lateness is tested with the step interface, by a lateness of 200 years.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c_kernel.building import HERE, SCENARIOS, STRICT, SUPPORT, kernel_files, need, run
from tests.support.compiling import compile_once

COUNTED = "-fsanitize-coverage=trace-pc"


@pytest.fixture(scope="module")
def bounds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    folder = tmp_path_factory.mktemp("bounds")
    include = (f"-I{SUPPORT}", f"-I{HERE}")
    kernel = [file for file in kernel_files() if not file.name.startswith("csp_port_")]
    compile_once("gcc", *STRICT, *SCENARIOS, *include, "-O1", COUNTED, "-c", *kernel, cwd=folder)
    others = [HERE / "bounds.c", HERE / "script.c", HERE / "steps.c", SUPPORT / "csp_port_simulation.c"]
    compile_once("gcc", *STRICT, *SCENARIOS, *include, "-O1", "-c", *others, cwd=folder)
    run("gcc", *sorted(folder.glob("*.o")), "-lm", "-o", folder / "bounds")
    return folder / "bounds"


def steps(bounds: Path, operation: str, size: int, times: int) -> int:
    return int(run(bounds, operation, str(size), str(times)).split()[-1])


def cost(bounds: Path, operation: str, size: int) -> float:
    """Of one operation."""
    return (steps(bounds, operation, size, 200) - steps(bounds, operation, size, 100)) / 100


@pytest.mark.parametrize("operation", ["rendezvous", "choice", "timers", "time-out"])
def test_some_operations_do_not_grow(bounds: Path, operation: str) -> None:
    """With other processes, with the guards of a choice among inputs, and with timers that end later."""
    assert 0 < cost(bounds, operation, 100) == cost(bounds, operation, 10) < 150


def test_a_choice_with_a_time_out_grows_with_its_guards(bounds: Path) -> None:
    few, many, most = (cost(bounds, "choice with time-out", size) for size in (10, 100, 1000))
    assert 0 < most - many <= 10.1 * (many - few)
    assert (most - many) / 900 < 10


def test_cancelling_grows_with_the_processes(bounds: Path) -> None:
    few, many, most = (steps(bounds, "cancel", size, 1) for size in (10, 100, 1000))
    assert 0 < most - many <= 10.1 * (many - few)
    assert (most - many) / 900 < 100
