"""Libraries of several programs in one image: nothing that one has is taken for what another has.

The programs have the same classes, and functions by hand of the same names, and compute different values; so whichever
function a linker takes for another shows in what they drive.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from itertools import permutations
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.codegen.options import FRAMEWORKS
from tests.c_kernel.building import need, run
from tests.conformance.sources import network_of, read
from tests.support.compiling import compile_once

PROGRAM = """enum Lamp {{ off, lit }}

struct Position {{
  opening : double
  lamps : Lamp[2]
}}

submodel Valve c "valve.c" {{
  in level : double
  out opening : double
}}

submodel Slow {{
  in x : double
  out y : double
  state kept : double = 0
  next kept = {weight} * kept + x
  y = kept
}}

process Tank {{
  in level : double @ {period} ms
  in button : bool
  out opening : double @ {period} ms safe -{weight}
  out lamp : Position
  communication {{
    valve : Valve
    slow : Slow
    var pressed : bool = false
    level -> valve.level
    valve.opening -> slow.x
    slow.y -> opening
  }}
  composition {{
    (mu (valve ; slow)) interrupt button ? pressed -> lamp ! Position(opening = 1, lamps = [Lamp.lit, Lamp.off])
  }}
}}
"""
HEADER = """#ifndef VALVE_H
#define VALVE_H
struct valve {
    double level;
    double opening;
};
void valve_initialize(struct valve *self);
void valve_reset(struct valve *self);
void valve_calculate(struct valve *self);
#endif
"""
SOURCE = """#include "valve.h"

#include <math.h>

extern const double offsets[2];
const double offsets[2] = {{{offset}, 0.0}};
static double half(double x);

/* A function that the header does not have. */
double valve_curve(double x)
{{
    return half(x) + offsets[0];
}}

static double half(double x)
{{
    return fabs(x) / 2.0;
}}

void valve_initialize(struct valve *self)
{{
    valve_reset(self);
}}

void valve_reset(struct valve *self)
{{
    self->opening = 0.0;
}}

void valve_calculate(struct valve *self)
{{
    self->opening = valve_curve(self->level);
}}
"""
USER = """#include <stdio.h>
#include "{name}_api.h"

static {name}_memory memory;
static int64_t reached;
static double level;

static bool sample(void *context, {name}_input input, {name}_inputs *inputs)
{{
    (void)context;
    (void)input;
    level += 0.25;
    inputs->level = level;
    return true;
}}

static void actuate(void *context, {name}_output output, const {name}_outputs *outputs, bool safe)
{{
    (void)context;
    (void)output;
    (void)printf("{name} %lld %.17g %d %d\\n", (long long)reached,
        outputs->opening, (int)outputs->lamp.lamps.at[0], safe);
}}

static uint32_t lock(void *context)
{{
    (void)context;
    return 0U;
}}

static void unlock(void *context, uint32_t before)
{{
    (void)context;
    (void)before;
}}

void step_{name}(int number)
{{
    static const {name}_hooks hooks = {{.sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock}};
    static {name}_instance *self;
    if (number == 0) {{
        self = {name}_begin(&memory, sizeof memory, &hooks, NULL);
    }}
    if (number == 17) {{
        (void){name}_button(self, true);
    }}
    reached = number * 1500000LL;
    (void){name}_advance(self, reached, 100U);
}}
"""
VERSIONS = {
    "tank": PROGRAM.format(weight=0.5, period=2),
    "tank2": PROGRAM.format(weight=0.5, period=2),
    "kettle": PROGRAM.format(weight=0.25, period=1),
}
"""`tank` and `tank2` are two versions of one program: only the law by hand has changed."""


MAIN = """#include <stdlib.h>
#include <string.h>
{declarations}
int main(int count, char **names)
{{
    for (int number = 0; number < 40; number++) {{
        for (int which = 1; which < count; which++) {{
{calls}
        }}
    }}
    return 0;
}}
"""


def package(name: str, folder: Path, framework: str = "", level: int = 0) -> Path:
    """The package of one of the programs, in a folder of that name."""
    source = folder / f"{name}.d"
    source.mkdir()
    (source / "valve.h").write_text(HEADER)
    (source / "valve.c").write_text(SOURCE.format(offset=float(list(VERSIONS).index(name))))
    built = pipeline.build(SourceFile(name=str(source / f"{name}.csp"), text=VERSIONS[name]), read_source)
    assert built.network is not None
    for path, text in pipeline.generate(built.network, read_source, "c", level, framework=framework).items():
        (folder / name / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / name / path).write_text(text)
    return folder / name


def users(folder: Path, names: Sequence[str]) -> list[Path]:
    """The sources of an application that advances the programs named as its arguments by turns."""
    declarations = "".join(f"void step_{name}(int number);\n" for name in names)
    calls = "\n".join(f'            if (strcmp(names[which], "{name}") == 0) step_{name}(number);' for name in names)
    texts = {f"use_{name}.c": USER.format(name=name) for name in names}
    texts["main.c"] = MAIN.format(declarations=declarations, calls=calls)
    for path, text in texts.items():
        (folder / path).write_text(text)
    return [folder / path for path in texts]


def foreign(library: Path, name: str) -> list[str]:
    """What a library shows to the linker without the prefix of its program."""
    rows = [row.split() for row in run("nm", "-P", "-g", library).splitlines()]
    shown = [row[0] for row in rows if len(row) > 1 and row[1] not in "Uw"]
    assert len(shown) > 100
    return [symbol for symbol in shown if not symbol.startswith(f"{name}_")]


def compare(images: Iterable[Path], names: Sequence[str]) -> None:
    """Each program drives what it drives without the others."""
    alone: dict[str, list[str]] = {}
    for image in images:
        for name in names:
            rows = run(image, name).splitlines()
            assert alone.setdefault(name, rows) == rows
            assert len(rows) > 10
        together = run(image, *names).splitlines()
        for name in names:
            assert [row for row in together if row.startswith(f"{name} ")] == alone[name]
    values = {tuple(row.partition(" ")[2] for row in rows) for rows in alone.values()}
    assert len(values) == len(names), "the programs do the same, so this shows nothing"


def test_the_libraries_for_other_frameworks_have_these_sources(tmp_path: Path) -> None:
    """So it suffices to link those for Zephyr, and for Arduino, which has options in its sources."""
    sources = set()
    for framework in sorted({*FRAMEWORKS} - {"arduino"}):
        (tmp_path / framework).mkdir()
        folder = package("tank", tmp_path / framework, framework) / "src"
        sources.add(tuple((path.relative_to(folder), path.read_text()) for path in sorted(folder.rglob("*.[ch]"))))
    assert len(sources) == 1


@pytest.mark.parametrize("framework", ["", "zephyr", "arduino"])
def test_libraries_of_three_programs_link_in_any_order(framework: str, tmp_path: Path) -> None:
    """The sources of each are compiled as the framework compiles them, into a library of each; the usual package by its
    Makefile.
    """
    need("gcc", "make", "ar", "nm")
    names, libraries, folders = tuple(VERSIONS), {}, []
    for number, name in enumerate(names):
        folder = package(name, tmp_path, framework, number % 2)
        libraries[name] = tmp_path / f"lib{name}.a"
        if framework:
            objects = folder / "objects"
            objects.mkdir()
            compile_once("gcc", "-std=gnu11", "-w", f"-I{folder / 'src'}", "-c", *folder.rglob("*.c"), cwd=objects)
            run("ar", "rcs", libraries[name], *objects.iterdir())
            folders.append(f"-I{folder / 'src'}")
        else:
            run("make", "-s", "-C", folder, "CFLAGS=-O0", libraries[name].name)
            shutil.copy(folder / libraries[name].name, libraries[name])
            folders.append(f"-I{folder}")
        assert foreign(libraries[name], name) == []
    sources, images = users(tmp_path, names), []
    for number, order in enumerate(permutations(libraries.values())):
        whole = ("-Wl,--whole-archive", *order, "-Wl,--no-whole-archive") if framework and number == 0 else order
        images.append(tmp_path / f"application{number}")
        compile_once("gcc", "-std=c99", *folders, *sources, *whole, "-lm", "-o", images[-1])
    compare(images, names)
    (tmp_path / "all.cpp").write_text("".join(f'#include "{name}_api.h"\n' for name in names))
    for compiler in (["gcc", "-std=c99", "-xc"], ["g++", "-std=c++11"] if shutil.which("g++") else ["gcc", "-xc"]):
        compile_once(
            *compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", *folders, "-fsyntax-only", tmp_path / "all.cpp"
        )


def test_two_versions_of_a_program_are_found_by_cmake(tmp_path: Path) -> None:
    need("cmake", "gcc", "make", "nm")
    names = ("tank", "tank2")
    for name in names:
        folder, built = package(name, tmp_path), tmp_path / f"built_{name}"
        run("cmake", "-S", folder, "-B", built)
        run("cmake", "--build", built, "-j2")
        run("cmake", "--install", built, "--prefix", tmp_path / "prefix")
        assert foreign(tmp_path / "prefix" / "lib" / f"lib{name}.a", name) == []
    sources = " ".join(file.name for file in users(tmp_path, names))
    project = "cmake_minimum_required(VERSION 3.13)\nproject(user C)\n"
    project += "".join(f"find_package({name} REQUIRED)\n" for name in names)
    images = []
    for order in permutations(names):
        linked = " ".join(f"{name}::{name}" for name in order)
        text = f"{project}add_executable(user {sources})\ntarget_link_libraries(user {linked})\n"
        (tmp_path / "CMakeLists.txt").write_text(text)
        built = tmp_path / f"user_{order[0]}"
        run("cmake", "-S", tmp_path, "-B", built, f"-DCMAKE_PREFIX_PATH={tmp_path / 'prefix'}")
        run("cmake", "--build", built)
        images.append(built / "user")
    compare(images, names)


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("program", ["jiwy", "cascade", "emergency", "dining"])
def test_no_library_shows_a_name_without_its_prefix(program: str, level: int, tmp_path: Path) -> None:
    """Also with reports to an observer, and with the port and the handlers of a POSIX system."""
    need("gcc", "nm")
    files = pipeline.generate(network_of(read(f"models/{program}/{program}.csp")), read, "c", level)
    for path, text in files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    (header,) = tmp_path.glob("*_api.h")
    compiled = [path for path in files if path.endswith(".c") and "csp_port_" not in path]
    compiled.append("support/csp_port_posix.c")
    objects = tmp_path / "objects"
    objects.mkdir()
    paths = [tmp_path / path for path in compiled]
    compile_once(
        "gcc", "-w", f"-DCSP_TRACE={level}", f"-I{tmp_path}", f"-I{tmp_path / 'support'}", "-c", *paths, cwd=objects
    )
    run("ar", "rcs", tmp_path / "library.a", *objects.iterdir())
    assert foreign(tmp_path / "library.a", header.stem.removesuffix("_api")) == ["main"]
