"""A replicated ``seq`` whose turns are all the same is a loop, however many there are; others are unrolled."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.network.elaborate.compose import MOST_UNROLLED
from cspdiag.network.ir.actions import Action, CountedLoop, ParallelSteps, SequentialSteps, SkipStep
from cspdiag.network.ir.walk import parts
from tests.network.programs import network, process

SOME = MOST_UNROLLED + 1
MAIN = """
process Main {{
  out y : int
  communication {{ var n : int = 0 }}
  composition {{ {body} ; y ! n }}
}}
"""


def first_step(body: str) -> Action:
    """The action of a composition, before another."""
    first = process(network(MAIN.format(body=body)), "Main").body
    assert isinstance(first, SequentialSteps)
    return first.steps[0]


def test_turns_that_are_all_the_same_are_a_loop() -> None:
    found = first_step(f"(seq i < {SOME} : y ! 1)")
    assert isinstance(found, CountedLoop)
    assert found.turns == SOME


def test_a_few_turns_are_written_down() -> None:
    found = first_step(f"(seq i < {MOST_UNROLLED} : y ! 1)")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MOST_UNROLLED


def test_no_turn_does_nothing() -> None:
    assert isinstance(first_step("(seq i < 0 : y ! 1)"), SkipStep)


@pytest.mark.parametrize("body", ["y ! i", "(y ! 1 ; n := i)", "(if i > 2 then y ! 1)", "(seq k < i + 1 : y ! 1)"])
def test_turns_that_differ_are_unrolled(body: str) -> None:
    found = first_step(f"(seq i < {SOME} : {body})")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == SOME


def test_the_index_of_a_sequence_around_it_does_not_unroll_a_loop() -> None:
    found = first_step(f"(seq i < 2 : (seq k < {SOME} : y ! i))")
    assert isinstance(found, SequentialSteps)
    assert [type(step) for step in found.steps] == [CountedLoop, CountedLoop]


def test_a_replicated_parallel_is_unrolled() -> None:
    found = first_step(f"(par i < {SOME} : wait 1 ms)")
    assert isinstance(found, ParallelSteps)
    assert len(found.steps) == SOME


LAW = """
submodel Law {{
  in  u : double
  out y : double
  state s : double = 0
  y      = s + u
  next s = y
}}
process Main {{
  in  u : double @ 1 ms
  out y : double @ 1 ms
  communication {{ law : Law  u -> law.u  law.y -> y }}
  composition {{ (seq i < {turns} : law) ; reset law }}
}}
submodel Plant {{
  in  y : double
  out u : double
  u = 1 - y / 8
}}
environment Bench for Main {{ plant : Plant  y -> plant.y  plant.u -> u }}
"""


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("target", ["python", "c"])
def test_code_for_many_turns_is_that_for_some(target: str, level: int) -> None:
    some, many = (
        pipeline.generate(network(LAW.format(turns=turns), environment="Bench"), read_source, target, level)
        for turns in (SOME, 60_013)
    )
    assert {name: text.replace("60013", str(SOME)) for name, text in many.items()} == some


def test_a_loop_is_one_step_of_the_network() -> None:
    made = network(LAW.format(turns=60_013))
    assert sum(1 for _ in parts(process(made, "Main"))) < 100
