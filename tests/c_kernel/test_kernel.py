"""The kernel of the C target: scenarios, each a C program of processes that are lists of steps, and the trace that it
must produce.

They are compiled with the strict flags of the generated packages by all available compilers, with sanitizers, and run
under valgrind.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import networkx
import pytest

from tests.c_kernel.building import HERE, PROGRAMS, SCENARIOS, STRICT, SUPPORT, kernel_files, need, run
from tests.support.compiling import compile_once


class Variant(NamedTuple):
    """A way to compile and run the scenarios."""

    compiler: str
    flags: Sequence[str]


VARIANTS: Mapping[str, Variant] = {
    "gcc": Variant("gcc", ("-g", "-O1")),
    "small": Variant("gcc", ("-Os",)),
    "clang": Variant("clang", ("-O1",)),
    "sanitizers": Variant("gcc", ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")),
}
VALGRIND = ("valgrind", "-q", "--error-exitcode=9", "--leak-check=full")
UNDER_VALGRIND = ("cancellation", "interrupts", "ports")


@pytest.fixture(scope="module", params=VARIANTS)
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Variant, Path]:
    """A variant, and the folder of its objects."""
    variant = VARIANTS[request.param]
    need(variant.compiler)
    folder = tmp_path_factory.mktemp(request.param)
    sources = [*kernel_files(), HERE / "script.c"]
    compile_once(variant.compiler, *STRICT, *variant.flags, *SCENARIOS, f"-I{SUPPORT}", "-c", *sources, cwd=folder)
    return variant, folder


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_scenario(built: tuple[Variant, Path], program: Path) -> None:
    variant, folder = built
    executable = folder / program.stem
    flags = (*STRICT, *variant.flags, *SCENARIOS, f"-I{SUPPORT}", f"-I{HERE}")
    compile_once(variant.compiler, *flags, program, *sorted(folder.glob("*.o")), "-lm", "-o", executable)
    expected = program.with_suffix(".txt").read_text()
    assert run(executable) == expected
    if variant == VARIANTS["gcc"] and program.stem in UNDER_VALGRIND and shutil.which("valgrind"):
        assert run(*VALGRIND, executable) == expected


PARTS = re.findall(r"#ifndef (CSP_USES_\w+)", (SUPPORT / "csp_parts.h").read_text())


@pytest.mark.parametrize("part", PARTS)
def test_kernel_compiles_without_a_part(part: str) -> None:
    need("gcc")
    compile_once("gcc", *STRICT, f"-D{part}=0", f"-I{SUPPORT}", "-fsyntax-only", *kernel_files())


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("configuration", ["-DCSP_TRACE=0", "-DCSP_LEVELS=1U", "nothing is used"])
def test_kernel_compiles_in_every_configuration(compiler: str, configuration: str) -> None:
    need(compiler)
    options = (configuration,) if configuration.startswith("-D") else tuple(f"-D{part}=0" for part in PARTS)
    compile_once(compiler, *STRICT, "-O2", *options, f"-I{SUPPORT}", "-fsyntax-only", *kernel_files())


def test_static_analysis() -> None:
    need("cppcheck")
    run(
        *("cppcheck", "--quiet", "--std=c99", "--enable=warning,style,performance,portability", "--error-exitcode=1"),
        *("--suppress=missingIncludeSystem", "--suppress=unusedStructMember", f"-I{SUPPORT}"),
        *kernel_files(),
        SUPPORT / "csp_linear.c",
        SUPPORT / "csp_port_posix.c",
        SUPPORT / "csp_signals.c",
        SUPPORT / "csp_watch.c",
    )


def test_kernel_has_no_recursion(tmp_path: Path) -> None:
    need("gcc")
    run("gcc", *STRICT, f"-I{SUPPORT}", "-fcallgraph-info", "-c", *kernel_files(), cwd=tmp_path)
    calls = networkx.DiGraph()
    for file in tmp_path.glob("*.ci"):
        calls.add_edges_from(re.findall(r'edge: { sourcename: "([^"]*)" targetname: "([^"]*)"', file.read_text()))
    assert len(calls) > 100
    assert list(networkx.simple_cycles(calls)) == []


def test_kernel_has_no_heap() -> None:
    calls = ("malloc", "calloc", "realloc", "free(", "alloca")
    for file in [*kernel_files(), *SUPPORT.glob("*.h")]:
        text = file.read_text()
        assert not [call for call in calls if call in text], file.name


def test_benchmarks_run(tmp_path: Path) -> None:
    """The benchmarks run and end; their speed is for people to read, not for tests to judge."""
    need("gcc")
    executable = tmp_path / "benchmark"
    compile_once("gcc", *STRICT, "-O1", f"-I{SUPPORT}", HERE / "benchmark.c", *kernel_files(), "-lm", "-o", executable)
    for benchmark in (("commstime",), ("alternative", "100"), ("ring", "1000"), ("parallel",)):
        name, figure, unit = run(executable, *benchmark).split()[:3]
        assert (name, unit.strip(",")) == (f"{benchmark[0]}:", "ns")
        assert float(figure) > 0
