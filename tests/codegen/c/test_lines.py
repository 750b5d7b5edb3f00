"""Lines of generated files are short, also with names that are long."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.codegen.c.package.folding import folded
from cspdiag.codegen.c.text.code import LINE_LENGTH
from cspdiag.codegen.options import FRAMEWORKS
from cspdiag.network.ir.network import CoreNetwork
from tests.support.compiling import compile_once

LONG_NAMES = """
enum OperatingModeOfTheController { waitingForTheOperator, heatingUpToTheSetPointOfTheZone }

parameter gainOfTheProportionalPartOfTheController : double = 2

exception TemperatureOfTheHeatingZoneIsNotPlausible

driver ConverterOfTheTemperatureOfTheZone(numberOfTheChannelOfTheConverter : int) c "converter.c" {
  out measuredTemperatureOfTheHeatingZone : double
  out emergencyStopButtonOfTheOperator : bool
  in  dutyCycleOfTheHeatingElementsOfTheZone[2] : double
  in  presentOperatingModeOfTheZone : OperatingModeOfTheController
}

submodel ProportionalControllerOfAHeatingZone(gainOfTheProportionalPart : double) {
  in  setPointOfTheTemperature, measuredTemperatureOfTheZone : double
  out dutyCycleOfTheHeatingElement : double
  state accumulatedDeviationOfTheZone : double = 0
  let deviationOfTheTemperature = setPointOfTheTemperature - measuredTemperatureOfTheZone
  dutyCycleOfTheHeatingElement =
    limit(gainOfTheProportionalPart * (deviationOfTheTemperature + accumulatedDeviationOfTheZone), 0, 1)
  next accumulatedDeviationOfTheZone = accumulatedDeviationOfTheZone + deviationOfTheTemperature
}

process SupervisoryControlOfAHeatingZone {
  in  measuredTemperatureOfTheHeatingZone : double @ 10 ms
  in  emergencyStopButtonOfTheOperator : bool
  out dutyCycleOfTheHeatingElementsOfTheZone[2] : double @ 10 ms safe 0
  out presentOperatingModeOfTheZone : OperatingModeOfTheController

  communication {
    controller : ProportionalControllerOfAHeatingZone(gainOfTheProportionalPartOfTheController)
    var emergencyStopHasBeenPressed : bool = false
    var setPoint : double = 0
    var dutyCycle : double = 0
    measuredTemperatureOfTheHeatingZone -> controller.measuredTemperatureOfTheZone
    setPoint -> controller.setPointOfTheTemperature
    controller.dutyCycleOfTheHeatingElement -> dutyCycle
  }

  composition {
    presentOperatingModeOfTheZone ! OperatingModeOfTheController.heatingUpToTheSetPointOfTheZone ;
    (mu (controller ; dutyCycleOfTheHeatingElementsOfTheZone[0] ! dutyCycle ;
         dutyCycleOfTheHeatingElementsOfTheZone[1] ! dutyCycle ;
         if dutyCycle > 2 then raise TemperatureOfTheHeatingZoneIsNotPlausible))
    interrupt emergencyStopButtonOfTheOperator ? emergencyStopHasBeenPressed ->
      presentOperatingModeOfTheZone ! OperatingModeOfTheController.waitingForTheOperator
  }
}

environment ConverterAndOutputsOfTheProcessor for SupervisoryControlOfAHeatingZone {
  converter : ConverterOfTheTemperatureOfTheZone(3)
  converter.measuredTemperatureOfTheHeatingZone -> measuredTemperatureOfTheHeatingZone
  converter.emergencyStopButtonOfTheOperator -> emergencyStopButtonOfTheOperator
  dutyCycleOfTheHeatingElementsOfTheZone -> converter.dutyCycleOfTheHeatingElementsOfTheZone
  presentOperatingModeOfTheZone -> converter.presentOperatingModeOfTheZone
}
"""

CONVERTER_HEADER = """
#include <stdbool.h>
#include <stdint.h>

#include "temperature_controller_of_heating_zones_2_types.h"

struct converter_of_the_temperature_of_the_zone {
    double measuredTemperatureOfTheHeatingZone;
    bool emergencyStopButtonOfTheOperator;
    double dutyCycleOfTheHeatingElementsOfTheZone[2];
    enum temperature_controller_of_heating_zones_2_operating_mode_of_the_controller
        presentOperatingModeOfTheZone;
    int64_t numberOfTheChannelOfTheConverter;
};

bool converter_of_the_temperature_of_the_zone_open(
    struct converter_of_the_temperature_of_the_zone *self,
    int64_t numberOfTheChannelOfTheConverter);
void converter_of_the_temperature_of_the_zone_close(
    struct converter_of_the_temperature_of_the_zone *self);
bool converter_of_the_temperature_of_the_zone_read_measuredTemperatureOfTheHeatingZone(
    struct converter_of_the_temperature_of_the_zone *self);
bool converter_of_the_temperature_of_the_zone_read_emergencyStopButtonOfTheOperator(
    struct converter_of_the_temperature_of_the_zone *self);
void converter_of_the_temperature_of_the_zone_write_dutyCycleOfTheHeatingElementsOfTheZone(
    struct converter_of_the_temperature_of_the_zone *self, uint32_t index);
void converter_of_the_temperature_of_the_zone_write_presentOperatingModeOfTheZone(
    struct converter_of_the_temperature_of_the_zone *self);
"""
MANIFESTS = ("CMakeLists.txt", "Makefile", "Kconfig", "LICENSE", ".yml")


def _read(path: str) -> SourceFile:
    texts = {"converter.c": "", "converter.h": CONVERTER_HEADER}
    if path not in texts:
        raise FileNotFoundError(path)
    return SourceFile(name=path, text=texts[path])


@cache
def _network() -> CoreNetwork:
    source = SourceFile(name="temperature_controller_of_heating_zones_2.csp", text=LONG_NAMES)
    built = pipeline.build(source, _read)
    assert built.network is not None, [f"{d.span}: {d.message}" for d in built.checked.report.diagnostics]
    return built.network


@pytest.mark.parametrize("framework", ["", *FRAMEWORKS])
@pytest.mark.parametrize("level", [0, 1])
def test_lines_with_long_names_are_broken(level: int, framework: str) -> None:
    package = pipeline.generate(_network(), _read, "c", level, framework=framework)
    own = [path for path in package if path.endswith((".c", ".h", *MANIFESTS)) and "csp_" not in path]
    assert len(own) > 12
    for path in own:
        long = [line for line in package[path].splitlines() if len(line) > LINE_LENGTH]
        assert [line for line in long if len(line.split()) > 1] == [], path


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
@pytest.mark.parametrize("level", [0, 1])
def test_lines_that_are_broken_compile(level: int, tmp_path: Path) -> None:
    package = pipeline.generate(_network(), _read, "c", level)
    for path, text in package.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    sources = [path for path in package if path.endswith(".c") and not path.startswith("support/")]
    compile_once("gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I.", "-Isupport", "-c", *sources, cwd=tmp_path)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("short(a);", ["short(a);"]),
        (
            f"static bool first_{'x' * 40}(struct second_{'x' * 20} *self, int64_t third);",
            [f"static bool first_{'x' * 40}(struct second_{'x' * 20} *self,", "    int64_t third);"],
        ),
        (
            f"    first_{'x' * 40} = second_{'x' * 50};",
            [f"    first_{'x' * 40} =", f"        second_{'x' * 50};"],
        ),
        (
            f"    if ((first_{'x' * 40} != NULL) && (second_{'x' * 40} != NULL)) {{",
            [f"    if ((first_{'x' * 40} != NULL)", f"            && (second_{'x' * 40} != NULL)) {{"],
        ),
        (
            f"    first_{'x' * 40}, /* {'word ' * 15}*/",
            [f"    /* {'word ' * 14}word */", f"    first_{'x' * 40},"],
        ),
        (f"/* {'word ' * 25}*/", [f"/* {'word ' * 18}word", f" * {'word ' * 5}word".rstrip(), " */"]),
        (
            f'fail("{"word " * 20}end");',
            ["fail(", f'    "{"word " * 16}"', f'    "{"word " * 4}end");'],
        ),
        (
            f"#define FIRST_{'X' * 40} first_{'x' * 60}",
            [f"#define FIRST_{'X' * 40} \\", f"    first_{'x' * 60}"],
        ),
        (f"    {'x' * 120},", [f"    {'x' * 120},"]),
    ],
)
def test_a_line_is_broken_as_a_person_would(text: str, lines: list[str]) -> None:
    assert folded(text).splitlines() == lines
