"""Names in generated code never clash with those of Python, of the runtime, or with each other."""

from __future__ import annotations

import builtins
import keyword

import pytest

from cspdiag import runtime
from cspdiag.codegen.python.text.names import (
    BUILTINS,
    KEYWORDS,
    MEMBERS,
    Names,
    identifier,
    member_names,
    snake_case,
)
from cspdiag.codegen.shared.places_in_arrays import indexed
from cspdiag.runtime import Process, Submodel


def test_keywords_and_builtins_are_known() -> None:
    assert frozenset(keyword.kwlist) == KEYWORDS
    functions = {name for name in dir(builtins) if name[0].islower()}
    assert functions - BUILTINS <= {"copyright", "credits", "exit", "help", "license", "quit"}


def test_members_of_the_base_classes_are_known() -> None:
    attributes = {*dir(Process), *dir(Submodel), *vars(Process("name"))}
    assert {name for name in attributes if not name.startswith("__")} <= MEMBERS


@pytest.mark.parametrize(
    ("name", "module"),
    [("PositionController", "position_controller"), ("PIDLoop", "pid_loop"), ("Class", "class_"), ("Law2", "law2")],
)
def test_modules_are_called_in_snake_case(name: str, module: str) -> None:
    assert snake_case(name) == module


def test_a_name_is_given_once() -> None:
    names = Names({"run"})
    assert [names[text] for text in ("max", "run", "pid.error", "pid_error", "max")] == [
        "max_",
        "run_",
        "pid_error",
        "pid_error_",
        "max_",
    ]


def test_names_with_indexes_are_places_in_lists() -> None:
    assert indexed("cell[3].output") == ("cell.output", 3)
    assert indexed("cell[3][1]") is None
    assert identifier("cell[3][1]") == "cell_3_1"


def test_the_runtime_exports_what_generated_code_imports() -> None:
    needed = "int64 uint8 float32 quotient remainder power nearest limit sign quantize deadzone element replaced sin"
    assert [name for name in needed.split() if not hasattr(runtime, name)] == []


def test_members_keep_apart_and_begin_with_no_underscore() -> None:
    given = member_names(("_x", "sum", "x", "sum_", "count", "__init__", "_1", "__"), frozenset({"count"}))
    assert dict(given) == {
        "_x": "x_",
        "sum": "sum_2",
        "x": "x",
        "sum_": "sum_",
        "count": "count_",
        "__init__": "init__",
        "_1": "n1",
        "__": "unnamed",
    }
