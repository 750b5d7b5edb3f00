"""Packages in C: they compile without a warning, are built by make and by CMake, and report the memory that
they need.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.files.resources import template_folder
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.memory import FunctionFacts, deepest, memory_report, unbounded

MODELS = Path(__file__).parents[3] / "models"
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
WARNINGS = (
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wcast-qual",
    "-Wshadow",
    "-Werror",
    "-fsyntax-only",
)

needs_compiler = pytest.mark.skipif(not COMPILERS, reason="there is no C compiler")


def network_of(name: str) -> CoreNetwork:
    network = pipeline.build(read_source(str(MODELS / name)), read_source).network
    assert network is not None
    return network


def written(files: Mapping[str, str], folder: Path) -> Path:
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder


@needs_compiler
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    "name", ["jiwy/jiwy.csp", "cascade/cascade.csp", "watchdog/watchdog.csp", "emergency/emergency.csp"]
)
def test_generated_code_gives_no_warnings(name: str, level: int, compiler: str, tmp_path: Path) -> None:
    folder = written(pipeline.generate(network_of(name), read_source, "c", level), tmp_path)
    sources = [str(path) for path in folder.glob("*.c")]
    for traced in ("0", "1"):
        command = [compiler, *WARNINGS, f"-DCSP_TRACE={traced}", f"-I{folder}", f"-I{folder}/support", *sources]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


NAMED = """
const NAME : double = 2
submodel Motor { in x : double  out y : double  y = x * NAME }
process Run {
  in x : double  out y : double
  communication { var v : double = NAME }
  composition { mu (x ? v ; y ! v * NAME) }
}
process Main {
  in x : double @ 1 ms
  in button : bool
  out y : double @ 1 ms safe NAME
  communication {
    var pressed : bool = false
    run : Run  m : Motor  x -> run.x  run.y -> c : double buffer 1 -> m.x  m.y -> y
  }
  composition { (run || (mu m)) interrupt button ? pressed -> wait rest }
}
submodel World { out x : double  out button : bool  x = time / 1 s  button = time > 1 s }
environment Bench for Main { world : World  world.x -> x  world.button -> button  y -> _ }
parameter rest = 1 ms
"""


@needs_compiler
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    "name",
    [
        *("motor_reset", "motor_initialize", "motor_calculate", "run_step", "run_places", "run_class", "main_ports"),
        *("network_initialize", "network_program", "bench_environment_advance", "bench_environment_drivers"),
        *("safe_y", "network_bring_button", "refuse", "follow", "set_parameters", "changed"),
    ],
)
def test_constants_may_be_called_like_functions_of_the_package(name: str, level: int, tmp_path: Path) -> None:
    file = SourceFile(name="named.csp", text=NAMED.replace("NAME", name))
    network = pipeline.build(file, read_source).network
    assert network is not None
    folder = written(pipeline.generate(network, read_source, "c", level), tmp_path)
    sources = [str(path) for path in folder.glob("*.c")]
    command = [COMPILERS[0], *WARNINGS, f"-I{folder}", f"-I{folder}/support", *sources]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_each_source_states_its_licence_once() -> None:
    """Those who collect the licences of a product look for it in each file."""
    files = pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c")
    lines = {path: text.splitlines() for path, text in files.items() if path.endswith((".c", ".h", ".ld", ".awk"))}
    assert len(lines) > 50
    for path, text in lines.items():
        assert [number for number, line in enumerate(text) if "SPDX-License-Identifier: 0BSD" in line] == [0], path


@needs_compiler
@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
def test_make_builds_the_simulation(tmp_path: Path) -> None:
    written(pipeline.generate(network_of("emergency/emergency.csp"), read_source, "c"), tmp_path)
    make = ["make", "-s", f"CC={COMPILERS[0]}", "CFLAGS=-O0"]
    subprocess.run(make, cwd=tmp_path, check=True, capture_output=True)
    program = tmp_path / "emergency_simulation"
    done = subprocess.run([program, "--for", "1000000000"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "1 s" in done.stderr
    wrong = subprocess.run([program, "--until", "1"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("usage:")
    unknown = subprocess.run([program, "--environment", "Mars"], capture_output=True, text=True, check=False)
    assert unknown.returncode == 2
    assert "no environment Mars; there are: " in unknown.stderr


@pytest.mark.skipif(not all(map(shutil.which, ("make", "clang"))), reason="there is no make or no clang")
def test_the_object_for_a_sanitizer_leaves_its_library_to_the_program(tmp_path: Path) -> None:
    folder = written(pipeline.generate(network_of("watchdog/watchdog.csp"), read_source, "c"), tmp_path)
    make = ["make", "-C", str(folder), "CC=clang", "CFLAGS=-O0 -fsanitize=undefined"]
    package = next(path.stem.removesuffix("_api") for path in folder.glob("*_api.h"))
    subprocess.run([*make, f"{package}.o"], capture_output=True, check=True)
    names = subprocess.run(["nm", folder / f"{package}.o"], capture_output=True, text=True, check=True).stdout
    runtime = {line.split()[-2] for line in names.splitlines() if line.split()[-1].startswith("__ubsan")}
    assert runtime == {"U"}  # Undefined here, so it is linked with the program.


@needs_compiler
@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
def test_make_works_when_headers_are_removed(tmp_path: Path) -> None:
    network = network_of("ring/ring.csp")
    make = ["make", "-s", f"CC={COMPILERS[0]}", "CFLAGS=-O0"]
    readable = pipeline.generate(network, read_source, "c")
    written(readable, tmp_path)
    subprocess.run(make, cwd=tmp_path, check=True, capture_output=True)
    fast = pipeline.generate(network, read_source, "c", 1)
    for path in readable.keys() - fast.keys():
        (tmp_path / path).unlink()
    written(fast, tmp_path)
    done = subprocess.run(make, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@needs_compiler
@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
def test_make_compiles_again_with_other_options(tmp_path: Path) -> None:
    """A library for the host is followed by one for the board: nothing of the first is in the second."""
    written(pipeline.generate(network_of("ring/ring.csp"), read_source, "c"), tmp_path)
    for options, compiled in (("-O0", True), ("-O0", False), ("-O1 -DNDEBUG", True)):
        make = ["make", f"CC={COMPILERS[0]}", f"CFLAGS={options}", "libring.a"]
        done = subprocess.run(make, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert ("-c network.c" in done.stdout) is compiled


@needs_compiler
@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no cmake")
def test_cmake_knows_all_files(tmp_path: Path) -> None:
    files = pipeline.generate(network_of("cascade/cascade.csp"), read_source, "c")
    text = files["CMakeLists.txt"]
    missing = [path for path in files if path.endswith(".c") and "csp_port_" not in path and f"  {path}\n" not in text]
    assert missing == []
    folder = written(files, tmp_path)
    subprocess.run(["cmake", "-S", folder, "-B", folder / "build"], check=True, capture_output=True, env={**os.environ})


@needs_compiler
@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no cmake")
def test_cmake_may_optimize_the_whole_image(tmp_path: Path) -> None:
    folder = written(pipeline.generate(network_of("buffer/buffer.csp"), read_source, "c"), tmp_path / "a package")
    built, installed = tmp_path / "built", tmp_path / "installed"
    whole = "-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON"
    for options in (
        ["-S", folder, "-B", built, whole, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DCMAKE_BUILD_TYPE=Release"],
        ["--build", built],
        ["--install", built, "--prefix", installed],
    ):
        done = subprocess.run(["cmake", *map(str, options)], check=True, capture_output=True, text=True)
        assert "warning" not in done.stdout + done.stderr
    commands = json.loads((built / "compile_commands.json").read_text())
    assert all("-flto" in each["command"] for each in commands)
    (tmp_path / "main.c").write_text(
        '#include "buffer_api.h"\n'
        "int main(void) { static buffer_memory m; return buffer_begin(&m, sizeof m, 0, 0) != 0; }\n"
    )
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.13)\nproject(user C)\nfind_package(buffer REQUIRED)\n"
        "add_executable(user main.c)\ntarget_link_libraries(user buffer::buffer)\n"
    )
    found = f"-DCMAKE_PREFIX_PATH={installed}"
    subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "user", whole, found], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", tmp_path / "user"], check=True, capture_output=True)
    assert subprocess.run([tmp_path / "user" / "user"], check=False).returncode in (0, 1)


@pytest.mark.parametrize("name", ["m", "c", "pthread", "rt", "dl", "util", "gcc", "test"])
def test_no_library_has_the_name_of_one_of_the_system(name: str, tmp_path: Path) -> None:
    text = "process Main { in x : double @ 10 ms  communication { var p : double } composition { mu x ? p } }"
    (tmp_path / f"{name}.csp").write_text(text)
    network = pipeline.build(read_source(str(tmp_path / f"{name}.csp")), read_source).network
    assert network is not None
    files = pipeline.generate(network, read_source, "c")
    assert f"add_library({name}_ STATIC" in files["CMakeLists.txt"]
    assert f"lib{name}_.a:" in files["Makefile"]
    assert f"lib{name}.a" not in files["Makefile"]
    if shutil.which("cmake") is not None and name == "m":
        folder = written(files, tmp_path / "package")
        subprocess.run(["cmake", "-S", folder, "-B", folder / "build"], check=True, capture_output=True)


@needs_compiler
@pytest.mark.parametrize("compiler", COMPILERS)
def test_the_memory_is_what_the_compiler_says(compiler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", compiler)
    network = network_of("ring/ring.csp")
    report = memory_report(network, pipeline.generate(network, read_source, "c"), 0)
    cells = next(item for item in report.sizes.classes if item.name == "Cell")
    assert cells.count == 10
    assert 0 < cells.bytes <= 100
    assert report.sizes.channels == 11
    assert 10 * cells.bytes < report.sizes.instance <= report.sizes.memory
    assert report.outside == 0
    assert 100 < report.stack < 10_000
    assert report.text.splitlines()[-1].startswith("  total")
    assert [size for _, size in report.frames] == sorted((size for _, size in report.frames), reverse=True)
    assert f"frame of {report.frames[0][0]}" in report.text
    assert len({len(line) for line in report.text.splitlines() if line.endswith(" bytes")}) == 1


def test_the_deepest_calls_make_the_stack() -> None:
    functions = {
        "main": FunctionFacts(10, ("run", "show")),
        "run": FunctionFacts(20, ("__indirect_call",)),
        "show": FunctionFacts(25, ()),
        "step": FunctionFacts(100, ("helper",)),
        "helper": FunctionFacts(7, ()),
    }
    assert deepest(functions) == 10 + 20 + 100 + 7
    assert unbounded(functions) == ""


def test_a_stack_may_have_no_bound() -> None:
    calls = {"step": ("law",), "law": ("deep",), "deep": ("deeper",), "deeper": ("deep",)}
    recursive = {name: FunctionFacts(8, called) for name, called in calls.items()}
    assert unbounded(recursive) == "deep calls itself, directly or through others"
    growing = {"step": FunctionFacts(8, ("law",)), "law": FunctionFacts(8, (), grows=True)}
    assert unbounded(growing) == "law has an array of variable length, or calls alloca"


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_make_shows_the_stack(tmp_path: Path) -> None:
    written(pipeline.generate(network_of("cascade/cascade.csp"), read_source, "c"), tmp_path)
    done = subprocess.run(
        ["make", "-s", "stack", "CFLAGS=-O1 -flto"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    rows = done.stdout.splitlines()
    table = done.stdout.partition("the deepest")[0].splitlines()
    depths = {row.split()[2]: int(row.split()[0]) for row in table}
    assert depths["cascade_next"] < depths["cascade_release"] < depths["cascade_advance"] < 2_000
    frames = done.stdout.partition("the frame of each function:\n")[2].splitlines()[:-1]
    sizes = [int(row.split()[0]) for row in frames]
    assert sizes == sorted(sizes, reverse=True)
    (own,) = [size for size, row in zip(sizes, frames, strict=True) if row.endswith(" cascade_advance")]
    assert own < depths["cascade_advance"]
    assert rows[-1] == "no function calls itself, directly or through others"


def test_recursion_is_found(tmp_path: Path) -> None:
    graph = tmp_path / "main.ci"
    nodes = "".join(f'node: {{ title: "{name}" label: "{name}\\n8 bytes (static)" }}\n' for name in ("p_a", "b", "c"))
    edges = [("p_a", "b"), ("b", "c"), ("c", "b")]
    rows = "".join(f'edge: {{ sourcename: "{one}" targetname: "{other}" }}\n' for one, other in edges)
    graph.write_text(nodes + rows, encoding="utf-8")
    script = template_folder("c") / "support" / "csp_stack.awk"
    done = subprocess.run(["awk", "-v", "package=p", "-f", script, graph], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "there is recursion"
    graph.write_text(nodes.replace("8 bytes (static)", "8 bytes (dynamic)", 1), encoding="utf-8")
    done = subprocess.run(["awk", "-v", "package=p", "-f", script, graph], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "no bound: p_a has an array of variable length, or calls alloca" in done.stdout.splitlines()
