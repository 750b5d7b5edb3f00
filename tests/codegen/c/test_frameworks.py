"""Packages as libraries for frameworks: their manifests name what is there, and everything compiles as the framework
would compile it. The functions of Zephyr and ESP-IDF for CMake are replaced by small ones that state what they do.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main
from cspdiag.codegen.options import FRAMEWORKS
from cspdiag.simulate.native.memory import report_or_reason
from tests.codegen.c.test_package import MODELS, needs_compiler, network_of, written
from tests.support.compiling import compile_once

JIWY = str(MODELS / "jiwy" / "jiwy.csp")

USER = """#include "jiwy_api.h"
int main(void)
{
    static jiwy_memory memory;
    return jiwy_begin(&memory, sizeof memory, 0, 0) != 0;
}
"""

ZEPHYR = """cmake_minimum_required(VERSION 3.13)
project(application C)
set(CONFIG_JIWY y)
function(zephyr_library_named name)
  add_library(${name} STATIC)
  set(ZEPHYR_CURRENT_LIBRARY ${name} PARENT_SCOPE)
endfunction()
function(zephyr_library_sources)
  target_sources(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGV})
endfunction()
function(zephyr_library_compile_options)
  target_compile_options(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGV})
endfunction()
function(zephyr_include_directories)
  foreach(folder ${ARGV})
    set_property(GLOBAL APPEND PROPERTY folders ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
    target_include_directories(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${folder})
  endforeach()
endfunction()
add_subdirectory("${PACKAGE}/zephyr" module)
get_property(folders GLOBAL PROPERTY folders)
add_executable(application main.c)
target_include_directories(application PRIVATE ${folders})
target_link_libraries(application -Wl,--whole-archive jiwy -Wl,--no-whole-archive m)
"""

ESP_IDF = """cmake_minimum_required(VERSION 3.16)
project(application C)
function(idf_component_register)
  cmake_parse_arguments(given "" "" "SRCS;INCLUDE_DIRS" ${ARGV})
  add_library(jiwy STATIC ${given_SRCS})
  target_include_directories(jiwy PUBLIC ${given_INCLUDE_DIRS})
  set(COMPONENT_LIB jiwy PARENT_SCOPE)
endfunction()
add_subdirectory("${PACKAGE}" component)
add_executable(application main.c)
target_link_libraries(application -Wl,--whole-archive jiwy -Wl,--no-whole-archive m)
"""


def library(framework: str, folder: Path) -> Path:
    files = pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c", 1, framework=framework)
    return written(files, folder / "a library")


@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no cmake")
@pytest.mark.parametrize(("framework", "project"), [("zephyr", ZEPHYR), ("esp-idf", ESP_IDF)])
def test_an_application_links_all_of_the_library(framework: str, project: str, tmp_path: Path) -> None:
    package = library(framework, tmp_path)
    application = written({"CMakeLists.txt": project, "main.c": USER}, tmp_path / "application")
    configure: list[str | Path] = ["cmake", "-S", application, "-B", tmp_path / "build", f"-DPACKAGE={package}"]
    subprocess.run(configure, check=True, capture_output=True)
    subprocess.run(["cmake", "--build", tmp_path / "build"], check=True, capture_output=True)
    assert subprocess.run([tmp_path / "build" / "application"], check=False).returncode == 0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("framework", ["platformio", "arduino"])
def test_all_sources_compile_with_one_folder_of_headers(framework: str, tmp_path: Path) -> None:
    package = library(framework, tmp_path)
    (package / "main.c").write_text(USER)
    sources = sorted((package / "src").rglob("*.c"))
    assert sources
    command: list[str | Path] = ["gcc", "-std=gnu11", "-w", "-O0", "-Isrc", "main.c", *sources, "-lm"]
    compile_once(*command, "-o", "application", cwd=package)
    assert subprocess.run([package / "application"], check=False).returncode == 0


@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="there is no compiler for Arm")
def test_a_library_for_arduino_is_compiled_without_contraction(tmp_path: Path) -> None:
    files = pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c", 1, framework="arduino")
    text = files["src/jiwy/joint_control.c"].partition("#include")[0]
    (tmp_path / "sum.c").write_text(f"{text}double sum(double a, double b, double c) {{ return a * b + c; }}\n")
    command = ["arm-none-eabi-gcc", "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-Os", "-S", "-o", "-"]
    assembly = subprocess.run([*command, tmp_path / "sum.c"], check=True, capture_output=True, text=True).stdout
    assert "vfma" not in assembly


def test_manifests_have_what_their_frameworks_require() -> None:
    made = {
        name: pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c", framework=name) for name in FRAMEWORKS
    }
    manifest = json.loads(made["platformio"]["library.json"])
    assert manifest["name"] == "jiwy"
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"])
    properties = dict(line.split("=", 1) for line in made["arduino"]["library.properties"].splitlines())
    assert {
        "name",
        "version",
        "author",
        "maintainer",
        "sentence",
        "paragraph",
        "category",
        "url",
        "architectures",
    } == set(properties)
    assert "build:\n  cmake: zephyr\n  kconfig: zephyr/Kconfig\n" in made["zephyr"]["zephyr/module.yml"]
    assert "config JIWY\n" in made["zephyr"]["zephyr/Kconfig"]
    assert re.search(r'^version: "\d+\.\d+\.\d+"$', made["esp-idf"]["idf_component.yml"], re.MULTILINE)
    for files in made.values():
        assert not [path for path in files if "simulation" in path or "posix" in path or "Makefile" in path]


def test_a_library_states_the_licence_of_what_was_generated() -> None:
    text = (MODELS.parent / "LICENSE").read_text()
    licence = text[text.index("\nZero-Clause BSD License\n") + 1 :]
    for framework in FRAMEWORKS:
        made = pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c", framework=framework)
        assert made["LICENSE"].split() == licence.split()
        if framework == "platformio":
            assert json.loads(made["library.json"])["license"] == "0BSD"
        if framework == "esp-idf":
            assert '\nlicense: "0BSD"\n' in made["idf_component.yml"]


def test_a_library_makes_no_claim_on_laws_in_c(tmp_path: Path) -> None:
    (tmp_path / "p.csp").write_text(
        'submodel Law c "law.c" { in x : double }\n'
        "process P { in x : double @ 1 ms  communication { law : Law  x -> law.x } composition { mu law } }\n"
    )
    (tmp_path / "law.c").write_text('#include "law.h"\n')
    (tmp_path / "law.h").write_text("#pragma once\nstruct law { double x; };\n")
    network = pipeline.build(read_source(str(tmp_path / "p.csp")), read_source).network
    assert network is not None
    for framework in ("platformio", "esp-idf"):
        made = pipeline.generate(network, read_source, "c", framework=framework)
        assert "  src/p/law.c\n  src/p/law.h\nThe licence of the others" in made["LICENSE"]
        assert "license" not in "".join(text for path, text in made.items() if path.startswith(("library", "idf")))


@pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no cmake")
def test_the_usual_package_is_found_by_cmake_once_it_is_installed(tmp_path: Path) -> None:
    package = written(pipeline.generate(network_of("jiwy/jiwy.csp"), read_source, "c", 1), tmp_path / "a package")
    user = "cmake_minimum_required(VERSION 3.13)\nproject(user C)\nfind_package(jiwy 1.0 REQUIRED)\n"
    user += "add_executable(user main.c)\ntarget_link_libraries(user jiwy::jiwy)\n"
    application = written({"CMakeLists.txt": user, "main.c": USER}, tmp_path / "user")
    prefix = tmp_path / "the prefix"
    commands: tuple[list[str | Path], ...] = (
        ["cmake", "-S", package, "-B", tmp_path / "one"],
        ["cmake", "--build", tmp_path / "one", "--target", "jiwy"],
        ["cmake", "--build", tmp_path / "one"],
        ["cmake", "--install", tmp_path / "one", "--prefix", prefix],
        ["cmake", "-S", application, "-B", tmp_path / "two", f"-DCMAKE_PREFIX_PATH={prefix}"],
        ["cmake", "--build", tmp_path / "two"],
    )
    for command in commands:
        subprocess.run(command, check=True, capture_output=True)
    assert subprocess.run([tmp_path / "two" / "user"], check=False).returncode == 0


def test_frameworks_are_for_c_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compile", JIWY, "--framework", "zephyr", "-o", str(tmp_path)]) == 2
    assert "--framework zephyr needs --target c" in capsys.readouterr().err
    assert main(["compile", JIWY, "--target", "c", "--framework", "zephyr", "-o", str(tmp_path)]) == 0
    assert (tmp_path / "jiwy" / "zephyr" / "module.yml").is_file()


@needs_compiler
def test_a_library_without_types_of_its_own_takes_the_memory_of_the_package() -> None:
    tank = str(MODELS.parent / "examples" / "c" / "superloop" / "tank.csp")
    network = pipeline.build(read_source(tank), read_source).network
    assert network is not None
    usual, library = (pipeline.generate(network, read_source, "c", framework=name) for name in ("", "zephyr"))
    assert "src/tank/types.h" not in library
    report = report_or_reason(network, library, 0)
    assert "instance, TANK_SIZE" in report
    assert report == report_or_reason(network, usual, 0)
