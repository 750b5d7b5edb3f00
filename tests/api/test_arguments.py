"""Every argument of the Python interface, with values that have no meaning for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy
import pytest

import cspdiag

PROGRAM = """const T : time = 10 ms
const gain = 2.0
const count = 1
const is_on = true

process Main {
  in  x : double @ T
  out y : double

  communication {
    var v : double = 0
  }

  composition {
    x ? v ; y ! if is_on then gain * double(count) else 0
  }
}

submodel Clock {
  out x : double

  x = time / 1<s>
}

environment Bench for Main {
  clock : Clock
  clock.x -> x
  y -> _
}
"""
SHORT = "10 ms"
program = cspdiag.parse(PROGRAM)
run = program.run(until=SHORT)
drawing = program.draw("Main")

NAMES: dict[str, Callable[[Any], object]] = {
    "parse": cspdiag.parse,
    "name of parse": lambda value: cspdiag.parse(PROGRAM, name=value),
    "top of build": lambda value: program.build(top=value),
    "environment of build": lambda value: program.build(environment=value),
    "top of graph": lambda value: program.graph(top=value),
    "process of draw": lambda value: program.draw(value),
    "label of draw": lambda value: program.draw(hide_labels=[value]),
    "top of timing": lambda value: program.timing(top=value),
    "environment of margins": lambda value: program.margins(value),
    "environment of run": lambda value: program.run(value),
    "process of run": lambda value: program.run(process=value),
    "process of verify": lambda value: program.verify(value),
    "signal": lambda value: run[value],
    "time of a signal": lambda value: run.time(value),
    "unread": lambda value: run.unread(value),
    "signal of to_dataframe": lambda value: run.to_dataframe([value]),
    "name of a setting": lambda value: program.build(set={value: 1}),
    "path of timing": lambda value: program.timing(measured={value: 1e-3}),
    "state of margins": lambda value: program.margins(at={value: 1.0}),
}
NUMBERS: dict[str, Callable[[Any], object]] = {
    "until": lambda value: program.run(until=value),
    "until of the reference": lambda value: program.run(until=value, level="reference"),
    "value of a setting": lambda value: program.build(set={"T": value}),
    "time limit": lambda value: program.verify(time_limit=value),
    "measured time": lambda value: program.timing(measured={"Main": value}),
    "time of the kernel": lambda value: program.timing(kernel=value),
    "scale": lambda value: drawing.save("unwritten.png", scale=value),
    "depth": lambda value: program.draw(depth=value),
}
MAPPINGS: dict[str, Callable[[Any], object]] = {
    "set of build": lambda value: program.build(set=value),
    "set of graph": lambda value: program.graph(set=value),
    "set of run": lambda value: program.run(set=value),
    "set of verify": lambda value: program.verify(set=value),
    "measured": lambda value: program.timing(measured=value),
    "at": lambda value: program.margins(at=value),
}
CHOICES: dict[str, Callable[[Any], object]] = {
    "target": lambda value: program.compile(value),
    "level of compile": lambda value: program.compile(level=value),
    "diagram": lambda value: program.draw(diagram=value),
    "target of run": lambda value: program.run(target=value),
    "level of run": lambda value: program.run(level=value),
    "scheme": lambda value: drawing.svg(scheme=value),
}
PATHS: dict[str, Callable[[Any], object]] = {
    "load": cspdiag.load,
    "check": cspdiag.check,
    "save": drawing.save,
    "to_csv": run.to_csv,
    "to_npz": run.to_npz,
    "to_trace": run.to_trace,
}

HUGE = 10**5000
"""More digits than Python converts to a text."""


def cases(functions: dict[str, Callable[[Any], object]]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("function", functions.values(), ids=functions)


@cases(NAMES)
@pytest.mark.parametrize(
    "value", [3, HUGE, math.nan, b"Main", ("Main",), object()], ids=lambda value: type(value).__name__
)
def test_a_name_has_to_be_a_text(function: Callable[[Any], object], value: object) -> None:
    with pytest.raises(TypeError, match=r"str"):
        function(value)


@cases(NUMBERS)
@pytest.mark.parametrize("value", [b"1", ["1"], object(), 1j], ids=lambda value: type(value).__name__)
def test_a_number_has_to_be_a_number(function: Callable[[Any], object], value: object) -> None:
    with pytest.raises(TypeError, match=r"number|int"):
        function(value)


@cases(NUMBERS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400, -HUGE, -1], ids=range(6))
def test_an_invalid_number_is_refused_with_a_reason(function: Callable[[Any], object], value: float) -> None:
    if function is NUMBERS["depth"] and (not isinstance(value, int) or value > 0):
        pytest.skip("deeper than a program is one picture of all of it")
    with pytest.raises(cspdiag.CspdiagError) as problem:
        function(value)
    assert isinstance(problem.value, cspdiag.SettingError | cspdiag.ArgumentError | cspdiag.ProgramError)


@cases(MAPPINGS)
@pytest.mark.parametrize("value", [3, "T", ["T"], b"T", False, 0], ids=lambda value: type(value).__name__)
def test_a_mapping_has_to_be_a_mapping(function: Callable[[Any], object], value: object) -> None:
    with pytest.raises(TypeError, match="is a mapping"):
        function(value)


@cases(CHOICES)
@pytest.mark.parametrize("value", [7, HUGE, math.nan, b"c", "C++", object()], ids=lambda value: type(value).__name__)
def test_a_choice_is_one_of_few(function: Callable[[Any], object], value: object) -> None:
    with pytest.raises(cspdiag.ArgumentError):
        function(value)


@cases(PATHS)
@pytest.mark.parametrize("value", [3.5, HUGE, ["x"], None], ids=lambda value: type(value).__name__)
def test_a_path_has_to_be_a_path(function: Callable[[Any], object], value: object) -> None:
    with pytest.raises(TypeError):
        function(value)


@cases(PATHS)
@pytest.mark.parametrize("value", ["a\0b.svg", "\ud800.svg"], ids=["zero", "half"])
def test_a_name_that_no_file_can_have(function: Callable[[Any], object], value: str) -> None:
    with pytest.raises(cspdiag.FileError):
        function(value)


@pytest.mark.parametrize("seconds", [0.02, numpy.float64(0.02), "20 ms"], ids=["float", "numpy", "text"])
def test_a_number_for_a_time_is_in_seconds(seconds: float | str) -> None:
    assert program.run(until="50 ms", set={"T": seconds}).time("x").tolist() == [0.02]


@pytest.mark.parametrize("text", ["9223372036854775807 ns", "-9223372036854775808ns", "9007199254740993 ns"])
def test_a_duration_is_set_exactly(text: str) -> None:
    shown = cspdiag.parse(
        "const d : time = 0 ns\nprocess P {\n  out y : time\n  communication {\n    var t : time = d\n  }\n"
        "  composition { y ! t }\n}\nenvironment E for P {\n  y -> _\n}\n"
    )
    assert shown.run(set={"d": text}).communications[0].value == int(text[: -len("ns")])


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ({"gain": numpy.float32(0.1)}, 0.1),
        ({"gain": 3}, 3.0),
        ({"count": numpy.int64(3)}, 6.0),
        ({"is_on": False}, 0.0),
        ({"is_on": numpy.bool_(False)}, 0.0),
    ],
    ids=range(5),
)
def test_numbers_of_numpy_are_numbers(setting: dict[str, Any], value: float) -> None:
    assert program.run(until=SHORT, set=setting)["y"][0] == value


def test_a_number_as_a_text_is_not_a_time() -> None:
    with pytest.raises(cspdiag.SettingError, match="unit"):
        program.build(set={"T": "0.02"})


def test_nothing_was_written() -> None:
    assert not Path("unwritten.png").exists()
