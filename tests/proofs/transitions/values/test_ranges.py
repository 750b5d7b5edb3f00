"""Ranges of numbers: what is known of a range holds for each of its numbers, and inputs and counters have no more
ranges than conditions distinguish.
"""

from __future__ import annotations

import operator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cspdiag.model.types import DOUBLE, INT, IntType
from cspdiag.proofs.transitions.ranges import (
    Cell,
    Range,
    bounds,
    cell,
    cell_of,
    cells,
    compared,
    computed,
    pieces,
    text,
)
from tests.proofs.transitions.building import component, listing, system_of
from tests.support.verifying import answers_to

COMPARISONS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
OPERATIONS = {"+": operator.add, "-": operator.sub, "*": operator.mul}
BYTE = IntType(8)

CELLS = st.tuples(st.integers(-6, 6), st.integers(0, 4)).map(lambda drawn: cell(drawn[0], drawn[0] + drawn[1]))


def numbers(value: Cell) -> range:
    low, high = bounds(value)
    return range(low, high + 1)


@given(st.sampled_from(sorted(COMPARISONS)), CELLS, CELLS)
def test_comparison_is_decided_where_all_numbers_agree(comparison: str, left: Cell, right: Cell) -> None:
    answers = {COMPARISONS[comparison](one, other) for one in numbers(left) for other in numbers(right)}
    assert compared(comparison, left, right) == (answers.pop() if len(answers) == 1 else None)


@given(st.sampled_from(sorted(OPERATIONS)), CELLS, CELLS)
def test_result_of_an_operation_has_all_that_its_numbers_give(sign: str, left: Cell, right: Cell) -> None:
    found = computed(sign, left, right, INT)
    assert found is not None
    results = [OPERATIONS[sign](one, other) for one in numbers(left) for other in numbers(right)]
    assert bounds(found) == (min(results), max(results))


def test_result_stays_within_its_type() -> None:
    assert computed("+", cell(100, 120), 10, BYTE) == cell(110, 127)
    assert computed("+", cell(120, 127), 10, BYTE) is None
    assert computed("/", cell(100, 120), 10, BYTE) is None


@given(st.sets(st.integers(-140, 140)), st.integers(-128, 127))
def test_every_number_is_in_one_cell(boundaries: set[int], number: int) -> None:
    all_cells = cells(BYTE, boundaries)
    assert not all_cells or [entry for entry in all_cells if number in numbers(entry)] == [cell_of(number, all_cells)]
    together = cell_of(cell(-128, 127), all_cells)
    assert together is None
    assert not all_cells or pieces(cell(-128, 127), all_cells) == all_cells


def test_numbers_are_written_as_their_range() -> None:
    ranges = [entry for entry in cells(INT, {3, 4, 10}) if isinstance(entry, Range)]
    assert [text(entry, INT) for entry in ranges] == ["..2", "4..9", "10.."]
    assert cells(DOUBLE, {3}) == ()


def test_an_input_is_split_as_far_as_conditions_distinguish() -> None:
    text = """process Main {
      in a : int
      out b : bool
      communication { var x : int = 0 }
      composition { (mu a ? x until x == 2) ; if x > 5 then b ! true }
    }"""
    system = system_of(text)
    assert [str(event) for event in system.events] == ["Main.a ..1", "Main.a.2", "Main.a 3..5", "Main.a 6.."]
    assert not system.abstractions
    assert listing(system, "Main").count("state") == 2


def test_an_input_passed_on_is_split_where_it_is_compared() -> None:
    text = """process Hands {
      in a : time
      out c : time
      communication { var x : time = 0 s }
      composition { mu (a ? x ; c ! x) }
    }
    process Compares(least: time) {
      in c : time
      out b : bool
      communication { var y : time = 0 s }
      composition { mu (c ? y ; if y - 1 ms >= least then b ! true) }
    }
    process Main {
      in a : time
      out b : bool
      communication { hands : Hands  compares : Compares(least = 5 ms)
        a -> hands.a  hands.c -> compares.c  compares.b -> b }
      composition { hands || compares }
    }"""
    system = system_of(text)
    assert [str(event) for event in system.events if event.visible] == [
        "Main.a ..5999999 ns",
        "Main.a 6 ms..",
        "Main.b.true",
    ]
    assert not system.abstractions


def test_an_input_with_many_ranges_is_left_open_if_there_are_too_many_states() -> None:
    """Three inputs with 17 ranges each: 4913 combinations, none of which is distinguished."""
    conditions = " ; ".join(f"(if {name} == {number} then b ! true)" for name in "xyz" for number in range(0, 16, 2))
    text = f"""process Main {{
      in a : int
      out b : bool
      communication {{ var x : int = 0  var y : int = 0  var z : int = 0 }}
      composition {{ mu (a ? x ; a ? y ; a ? z ; {conditions}) }}
    }}"""
    system = system_of(text)
    assert len(component(system, "Main").edges) < 3_000
    reported = [abstraction.what for abstraction in system.abstractions]
    assert "the values of `x` are not followed: there are too many" in reported


POISON = """process Source(items: int = 500) {
  out output : int
  communication { var n : int = 0 }
  composition { (mu (output ! n ; n := n + 1) until n == items) ; output ! -1 }
}

process Sink {
  in input : int
  communication { var x : int = 0 }
  composition { mu input ? x until x == -1 }
}

process Line {
  communication { source : Source  sink : Sink
    source.output -> sink.input }
  composition { source || sink }
}

assert Line deadlock free
"""


def test_counter_never_has_the_value_that_ends_the_stream() -> None:
    (answer,) = answers_to({"case.csp": POISON})
    assert answer.outcome == "proved"
    (answer,) = answers_to({"case.csp": POISON.replace("x == -1", "x == 300")})
    assert (answer.outcome, answer.replayed) == ("refuted", True), "the sink ends before its source, after 300 numbers"


REFINES = """process Button(least: int) {
  in  pressed : int
  out lamp    : bool
  communication { var code : int = 0 }
  composition { mu (pressed ? code ; if code >= least then lamp ! true) }
}

process Has {
  in  pressed : int
  out lamp    : bool
  communication { button : Button(least = 3)
    pressed -> button.pressed  button.lamp -> lamp }
  composition { button }
}

process Demands {
  in  pressed : int
  out lamp    : bool
  communication { button : Button(least = LEAST)
    pressed -> button.pressed  button.lamp -> lamp }
  composition { button }
}

assert Has refines Demands
assert Has refines Demands in failures
"""


@pytest.mark.parametrize(("least", "outcome"), [(3, "proved"), (2, "refuted"), (4, "refuted")])
def test_a_specification_splits_its_inputs_elsewhere(least: int, outcome: str) -> None:
    in_traces, in_failures = answers_to({"case.csp": REFINES.replace("LEAST", str(least))})
    assert (in_traces.outcome, in_traces.replayed) == (outcome, outcome == "refuted")
    assert (in_failures.outcome == "proved") == (outcome == "proved")


LENIENT = """process Demands {
  in  pressed : int
  out lamp    : bool
  communication { var code : int = 0 }
  composition { mu (pressed ? code ; if code >= LEAST then (lamp ! true -> skip [] skip -> skip)) }
}
"""


@pytest.mark.parametrize(("least", "outcome"), [(2, "proved"), (3, "proved"), (4, "refuted")])
def test_specification_leaves_open_whether_the_lamp_is_lit(least: int, outcome: str) -> None:
    head, tail = REFINES.split("process Demands")
    text = head + LENIENT.replace("LEAST", str(least)) + tail[tail.index("assert Has refines Demands\n") :]
    (answer, _) = answers_to({"case.csp": text})
    assert answer.outcome == outcome


COUNTS = """process Counts {
  in  go    : bool
  out count : int
  communication { var n : int = 0  var g : bool = false }
  composition { mu (go ? g ; n := n + 1 ; count ! n) until n >= MOST }
}

process Demands {
  in  go    : bool
  out count : int
  communication { var g : bool = false }
  composition { go ? g ; count ! 1 ; go ? g ; count ! 2 }
}

assert Counts refines Demands
"""


@pytest.mark.parametrize(("most", "outcome"), [(1, "refuted"), (2, "proved"), (3, "refuted")])
def test_numbers_that_a_specification_writes_are_distinguished(most: int, outcome: str) -> None:
    (answer,) = answers_to({"case.csp": COUNTS.replace("MOST", str(most))})
    assert (answer.outcome, answer.replayed) == (outcome, outcome == "refuted"), answer.reason


def test_number_of_a_range_is_not_the_same_as_another_one() -> None:
    """Both write a number of at least 3, but not the same one."""
    text = """process Adds {
      in a : int
      out b : int
      communication { var x : int = 0 }
      composition { a ? x ; if x > 2 then b ! x + 1 }
    }
    process Copies {
      in a : int
      out b : int
      communication { var x : int = 0 }
      composition { a ? x ; if x > 2 then (if x == 3 then b ! 3 else b ! x) }
    }
    assert Adds refines Copies
    """
    (answer,) = answers_to({"case.csp": text})
    assert answer.outcome != "proved"
