"""Which process is the outermost one of a program without an environment: the same for proofs, runs, code and
pictures.
"""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.pictures import Pictures

CELL = """
process Robot {
  in  arrived : bool
  out placed  : bool
  communication { var part : bool = false }
  composition { mu (arrived ? part ; placed ! part) }
}
process Cell {
  in  arrived : bool
  out placed  : bool
  communication {
    robot : Robot
    arrived -> robot.arrived
    robot.placed -> placed
  }
  composition { robot }
}
"""
SPECIFICATION = CELL[: CELL.index("process Cell")].replace("Robot", "Specification")


def _outermost(text: str) -> str:
    built = pipeline.build(SourceFile(name="main.csp", text=text), read_source)
    assert built.network is not None
    assert built.checked.program is not None
    drawn = Pictures(built.checked.program).outermost()
    top = built.network.class_named(built.network.top).definition
    assert drawn is not None
    assert drawn.name.text == top
    return top


@pytest.mark.parametrize("model", ["", " in failures"])
def test_a_specification_is_not_the_outermost_process_although_it_is_last(model: str) -> None:
    assert _outermost(f"{CELL}{SPECIFICATION}assert Cell refines Specification{model}\n") == "Cell"


def test_the_last_process_that_is_not_a_specification_is_the_outermost_one() -> None:
    assert _outermost(f"{CELL}{SPECIFICATION}assert Cell deadlock free\n") == "Specification"


def test_what_is_asserted_of_a_specification_itself_changes_nothing() -> None:
    assertions = "assert Specification deadlock free\nassert Cell refines Specification\n"
    assert _outermost(f"{CELL}{SPECIFICATION}{assertions}") == "Cell"


def test_a_specification_is_the_outermost_process_where_there_is_no_other() -> None:
    assert _outermost(f"{SPECIFICATION}assert Specification refines Specification\n") == "Specification"
