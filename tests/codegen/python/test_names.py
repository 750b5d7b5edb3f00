"""Names in generated code never clash with those of Python, of the runtime, or with each other."""

from __future__ import annotations

import builtins
import keyword
from collections.abc import Mapping

import pytest

from cspdiag import runtime
from cspdiag.base.span import SourceFile, Span
from cspdiag.codegen.python.text.names import (
    BUILTINS,
    KEYWORDS,
    MEMBERS,
    Names,
    identifier,
    member_names,
    snake_case,
)
from cspdiag.codegen.shared.places_in_arrays import MANY, Arrays, indexed, numbered_lines
from cspdiag.network.ir.network import InstanceOf
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


def _rows(kinds: Mapping[str, str]) -> list[InstanceOf]:
    span = Span(SourceFile(name="main.csp", text=""), 0, 0)
    return [InstanceOf(name=name, class_name=kind, span=span) for name, kind in kinds.items()]


def test_many_numbered_names_of_one_kind_are_an_array() -> None:
    cells = {f"cell{i}.out": "sync" for i in range(MANY)}
    assert numbered_lines(cells, ()) == {"cell.out": list(cells)}
    arrays = Arrays((_rows(cells), lambda row: row.class_name))
    assert arrays.place("cell7.out") == ("cell.out", 7)
    assert arrays.element("cell.out", 7) == "cell7.out"
    assert arrays.size("cell7.out") == MANY


@pytest.mark.parametrize(
    "names",
    [
        [f"cell{i}" for i in range(MANY - 1)],
        [f"cell{i}" for i in range(1, MANY + 1)],
        [f"cell{i}" for i in range(MANY) if i != 7] + ["cell100"],
        [f"cell{i}" for i in reversed(range(MANY))],
        [f"cell{i:03}" for i in range(MANY)],
        [f"cell{i}.x{i}" for i in range(MANY)],
        [f"cell[0].x{i}" for i in range(MANY)],
        [f"cell{i}x" for i in range(MANY)],
        [f"cell{i}" for i in range(MANY)] + ["cell"],
    ],
)
def test_other_names_are_no_array(names: list[str]) -> None:
    assert numbered_lines(dict.fromkeys(names, "sync"), names) == {}


def test_numbered_names_of_several_kinds_or_with_a_name_that_is_taken_are_no_array() -> None:
    kinds = {f"cell{i}": "Cell" for i in range(MANY)}
    assert numbered_lines(kinds | {"cell7": "Head"}, ()) == {}
    assert numbered_lines(kinds, {"cell"}) == {}
    of_kind = [_rows({f"cell[{i}]": "Cell" for i in range(MANY)}), _rows(kinds)]
    both = Arrays(*((rows, lambda row: row.class_name) for rows in of_kind))
    assert both.place("cell[7]") == ("cell", 7)
    assert both.place("cell7") == ("cell7", None)
