"""How the tests of the kernel compile and run it."""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SUPPORT = Path(__file__).parents[2] / "templates" / "c" / "support"
PROGRAMS = tuple(sorted((HERE / "programs").glob("*.c")))
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wcast-qual", "-Wshadow", "-Werror")
SCENARIOS = ("-DCSP_TRACE=1", "-DCSP_LEVELS=3U")
HOSTED = (
    "csp_linear.c", "csp_signals.c", "csp_simulation.c", "csp_simulation_posix.c", "csp_steering_posix.c",
    "csp_stream.c", "csp_stream_posix.c", "csp_tuning_posix.c", "csp_watch.c",
)  # fmt: skip
"""Files for a run on a host, which are not part of the kernel."""


def run(*command: str | Path, cwd: Path | None = None) -> str:
    completed = subprocess.run([*command], cwd=cwd, capture_output=True, text=True, timeout=120, check=False)
    assert completed.returncode == 0, f"{completed.stdout}{completed.stderr}"
    return completed.stdout


def need(*tools: str) -> None:
    missing = [tool for tool in tools if shutil.which(tool) is None]
    if missing:
        pytest.skip(f"not installed: {', '.join(missing)}")


@cache
def _links_with(compiler: str, option: str) -> bool:
    """Whether a compiler has the libraries that an option needs; those of clang's sanitizers are a package apart."""
    command = [compiler, option, "-x", "c", "-", "-o", os.devnull]
    return subprocess.run(command, input="int main(void) { return 0; }", text=True, capture_output=True).returncode == 0


def need_sanitizers(compiler: str, sanitizers: str) -> None:
    """Skip the test if the compiler or the libraries of its sanitizers are missing."""
    need(compiler)
    if not _links_with(compiler, f"-fsanitize={sanitizers}"):
        pytest.skip(f"not installed: the sanitizers of {compiler} (Debian: libclang-rt-14-dev)")


def kernel_files(port: str = "simulation") -> list[Path]:
    """The kernel with one of its ports."""
    files = [file for file in sorted(SUPPORT.glob("csp_*.c")) if file.name not in HOSTED]
    of_port = [
        SUPPORT / f"csp_port_{port}.c",
        *([SUPPORT / "csp_signals.c", SUPPORT / "csp_watch.c"] if port == "posix" else []),
    ]
    return [file for file in files if not file.name.startswith("csp_port_")] + of_port
