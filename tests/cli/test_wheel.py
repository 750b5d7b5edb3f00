"""The wheel is complete: it works in an environment of its own, from another folder."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

Installed = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder, ROOT]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Run a program of an otherwise empty environment with the wheel, in a folder with the models and nothing else.

    The dependencies of cspdiag are borrowed from the environment of the tests, so nothing is downloaded.
    """
    environment = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    python = environment / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", python, "--disable-pip-version-check"]
    subprocess.run([*pip, "install", "--quiet", "--no-index", "--no-deps", wheel], check=True)
    own = subprocess.check_output([python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"], text=True)
    (Path(own.strip()) / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    folder = tmp_path_factory.mktemp("elsewhere")
    shutil.copytree(ROOT / "models", folder / "my models")

    def run(program: str, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
        clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COV_"))}
        command = [environment / "bin" / program, *arguments]
        return subprocess.run(command, cwd=folder, env=clean, capture_output=True, text=True)

    return run


def test_the_wheel_ships_what_is_needed(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for needed in (
        "cspdiag/py.typed",
        "cspdiag/std/control.csp",
        "cspdiag/_resources/grammars/csp.lark",
        "cspdiag/_resources/manual/01-syntax/E0101.md",
        "cspdiag/_resources/templates/project/controller.csp",
        "cspdiag/_resources/benchmarks/__main__.py",
        "cspdiag/runtime/__init__.py",
    ):
        assert needed in names
    assert any(name.startswith("cspdiag/_resources/templates/python/") for name in names)
    assert not any(name.startswith(("tests/", "models/")) or name.endswith(".pyc") for name in names)
    (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
    assert "License-Expression: MIT AND 0BSD" in zipfile.ZipFile(wheel).read(metadata).decode()


def test_the_wheel_draws_without_anything_fetched(wheel: Path, installed: Installed) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    if "cspdiag/_resources/third-party/elkjs/elk-worker.min.js" not in names:
        pytest.skip("the layout engine was not fetched (make setup)")
    assert "cspdiag/_resources/third-party/elkjs/LICENSE.md" in names
    for output in ("jiwy.png", "jiwy.pdf"):
        drawn = installed("cspdiag", "draw", "my models/jiwy/jiwy.csp", "-o", output)
        assert drawn.returncode == 0, drawn.stderr
    booked = installed("cspdiag", "draw", "my models/jiwy/jiwy.csp", "--book", "jiwy.html")
    assert booked.returncode == 0, booked.stderr


def test_the_installed_package_is_used(installed: Installed) -> None:
    result = installed("python", "-c", "import cspdiag, sys; print(cspdiag.__file__.startswith(sys.prefix))")
    assert result.stdout == "True\n"


def test_check_compile_and_run_work_elsewhere(installed: Installed) -> None:
    program = "my models/jiwy/jiwy.csp"
    checked = installed("cspdiag", "check", program)
    assert checked.returncode == 0, checked.stderr
    compiled = installed("cspdiag", "compile", program, "-o", "out")
    assert compiled.returncode == 0, compiled.stderr
    ran = installed("cspdiag", "run", program, "--for", "100ms", "--record", "out/run.csv")
    assert ran.returncode in {0, 1}, ran.stderr
    assert "internal error" not in ran.stderr
    recorded = installed("python", "-c", "print(open('out/run.csv').readline())")
    assert recorded.stdout.startswith("time,"), ran.stderr


def test_the_benchmarks_run_elsewhere(installed: Installed) -> None:
    for name, shown in (
        ("commstime", "\n  -O1 "),
        ("check-cold", "\n  cspdiag "),
        ("check-server", "\n  cspdiag "),
        ("prove-controller-4", "\n  cspdiag "),
    ):
        result = installed("cspdiag", "bench", "--only", name, "--rounds", "1")
        assert result.returncode == 0, result.stderr
        assert shown in result.stdout


def test_a_project_can_be_started_and_a_page_read(installed: Installed) -> None:
    assert installed("cspdiag", "new", "gimbal").returncode == 0
    assert installed("cspdiag", "check", "gimbal/gimbal.csp").returncode == 0
    assert "Fixed" in installed("cspdiag", "explain", "E0101").stdout


def test_a_strict_type_checker_knows_the_installed_package(installed: Installed, tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    script = tmp_path / "control.py"
    script.write_text(
        "import cspdiag\n\n"
        "def highest(path: str) -> float:\n"
        '    """What the first output reaches."""\n'
        "    try:\n"
        '        run = cspdiag.load(path).run("Bench", until="50 ms")\n'
        "    except cspdiag.CspdiagError as problem:\n"
        "        raise SystemExit(problem.diagnostics[0].message)\n"
        '    return float(run["control_vertical"].max())\n\n'
        "reveal_type(cspdiag.load)\n"
        "cspdiag.load(1)\n"
    )
    # The types of the dependencies stay the same.
    cache = ("--cache-dir", ROOT / ".mypy_cache" / "of the wheel")
    result = installed("python", "-m", "mypy", "--strict", "--no-error-summary", *cache, script)
    revealed, refused = result.stdout.splitlines()
    assert "LoadedProgram" in revealed
    assert re.search(r'^\S+:12: error: Argument 1 to "load" has incompatible type "int"', refused)
