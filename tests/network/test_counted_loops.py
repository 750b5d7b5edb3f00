"""A replicated ``seq`` with many iterations is a counted loop if they differ only in values; other ones are
unrolled.
"""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.network.elaborate.counted_loops import MOST_ALIKE_UNROLLED, MOST_UNROLLED
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    CountedLoop,
    IfElse,
    ParallelSteps,
    SequentialSteps,
    SkipStep,
)
from cspdiag.network.ir.walk import parts
from tests.codegen.c.test_golden import BUILD
from tests.network.programs import network, process


def without_builds(files: Mapping[str, str]) -> dict[str, str]:
    """The files without the identities of builds, which differ where anything does."""
    return {name: BUILD.sub("", text) for name, text in files.items()}


SOME = MOST_ALIKE_UNROLLED + 1
MANY = MOST_UNROLLED + 1
MAIN = """
process Main {{
  out y : int
  communication {{ var n : int = 0 }}
  composition {{ {body} ; y ! n }}
}}
"""


def codes(text: str) -> list[str]:
    """The diagnostics of the checks."""
    checked = pipeline.check(SourceFile(name="main.csp", text=text), read_source)
    return [diagnostic.code for diagnostic in checked.report.diagnostics]


def first_step(body: str) -> Action:
    """The action of a composition, before another one."""
    first = process(network(MAIN.format(body=body)), "Main").body
    assert isinstance(first, SequentialSteps)
    return first.steps[0]


def test_equal_iterations_are_a_loop() -> None:
    found = first_step(f"(seq i < {SOME} : y ! 1)")
    assert isinstance(found, CountedLoop)
    assert found.iterations == SOME


def test_a_few_iterations_are_unrolled() -> None:
    found = first_step(f"(seq i < {MOST_ALIKE_UNROLLED} : y ! 1)")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MOST_ALIKE_UNROLLED


def test_zero_iterations_do_nothing() -> None:
    assert isinstance(first_step("(seq i < 0 : y ! 1)"), SkipStep)


VALUES = ["y ! i", "(y ! 1 ; n := i)", "(if i > 2 then y ! 1)", "wait i * 1 us", "(skip -> y ! i)"]


@pytest.mark.parametrize("body", VALUES)
def test_some_iterations_with_different_values_are_unrolled(body: str) -> None:
    found = first_step(f"(seq i < {MOST_UNROLLED} : {body})")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MOST_UNROLLED


@pytest.mark.parametrize("body", VALUES)
def test_many_iterations_with_different_values_are_a_counting_loop(body: str) -> None:
    found = first_step(f"(seq i < {MANY} : {body})")
    assert isinstance(found, SequentialSteps)
    begin, loop = found.steps
    assert isinstance(begin, AssignValue)
    assert isinstance(loop, CountedLoop)
    assert (begin.target.channel, loop.iterations) == ("i", MANY)


def test_a_count_by_the_index_around_it_unrolls_a_sequence() -> None:
    found = first_step(f"(seq i < {MANY} : (seq k < i + 1 : y ! 1))")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MANY


def test_indexes_of_the_same_name_have_variables_of_their_own() -> None:
    body = f"((seq i < {MANY} : y ! i) ; (seq i < {MANY} : y ! i) ; (seq i_2 < {MANY} : y ! i_2))"
    main = process(network(MAIN.format(body=body)), "Main")
    assert [channel.name for channel in main.channels] == ["n", "i", "i_2", "i_2_2"]


def test_an_index_that_counts_in_another_loop_is_a_value_there() -> None:
    main = process(network(MAIN.format(body=f"(seq i < {MANY} : (seq k < {MANY} : y ! i + k))")), "Main")
    assert [part.iterations for part in parts(main) if isinstance(part, CountedLoop)] == [MANY, MANY]


def test_a_condition_that_holds_in_every_iteration_decides_nothing_in_the_run() -> None:
    same, different = (
        process(network(MAIN.format(body=f"(seq i < {MANY} : (if i < {limit} then y ! i else y ! 0))")), "Main")
        for limit in (MANY, MANY - 1)
    )
    assert not any(isinstance(part, IfElse) for part in parts(same))
    assert any(isinstance(part, IfElse) for part in parts(different))


@pytest.mark.parametrize(
    "body",
    [
        "(when i > 2 & skip -> y ! 1 []> after 1 ms -> skip)",
        "((if i % 2 == 0 then n := 1) || (if i % 2 == 1 then n := 2))",
        "(par k < 2 : if k == i % 2 then n := 1)",
        "((wait 1 ms) interrupt after 1 us -> (if i > 2 then y ! 1))",
    ],
)
def test_conditions_that_make_parts_of_iterations_exclusive_unroll_them(body: str) -> None:
    found = first_step(f"(seq i < {MANY} : {body})")
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MANY


def test_a_condition_on_the_iteration_can_give_a_variable_its_first_value() -> None:
    assert (
        codes(MAIN.replace("int = 0", "int").format(body=f"(seq i < {MANY} : (if i == 0 then n := 1) ; y ! n)")) == []
    )


def test_what_counts_after_a_turn_that_never_ends_is_no_unreachable_part_of_the_text() -> None:
    text = MAIN.format(body=f"(seq i < {MANY} : (y ! i ; mu (y ! i ; wait 1 ms)))")
    (found,) = pipeline.check(SourceFile(name="main.csp", text=text), read_source).report.diagnostics
    assert (found.code, found.span.text) == ("W0611", "y ! n")


def test_iterations_of_nested_loops_are_counted_together() -> None:
    assert codes(MAIN.format(body="(seq i < 400 : (seq k < 400 : y ! i + k))")) == ["E0506"]


STRUCTURE = """
process Cell {{
  out y : int
  composition {{ y ! 1 }}
}}
process Main {{
  out array[{turns}] : int
  communication {{
    cell[{turns}] : Cell
    for k < {turns} {{ cell[k].y -> array[k] }}
  }}
  composition {{ ({body}) ; (seq k < {turns} : cell[k]) }}
}}
"""


@pytest.mark.parametrize("body", ["cell[i]", "array[i] ! 1", "(array[1] ! i ; cell[{turns} - 1 - i])"])
def test_iterations_that_choose_parts_of_the_network_are_unrolled(body: str) -> None:
    text = STRUCTURE.format(turns=MANY, body=f"seq i < {MANY} : {body.format(turns=MANY)}")
    main = process(network(text), "Main").body
    assert isinstance(main, SequentialSteps)
    found = main.steps[0]
    assert isinstance(found, SequentialSteps)
    assert len(found.steps) == MANY


def test_the_index_of_a_sequence_around_it_does_not_unroll_a_loop() -> None:
    found = first_step(f"(seq i < 2 : (seq k < {SOME} : y ! i))")
    assert isinstance(found, SequentialSteps)
    assert [type(step) for step in found.steps] == [CountedLoop, CountedLoop]


def test_a_replicated_parallel_is_unrolled() -> None:
    found = first_step(f"(par i < {SOME} : wait 1 ms)")
    assert isinstance(found, ParallelSteps)
    assert len(found.steps) == SOME


COUNTING = """
process Main {{
  out y : int
  communication {{ var last : int = 0 }}
  composition {{ (seq i < {turns} : (last := i ; (skip -> y ! last [] after 1 ms -> wait i * 1 us))) }}
}}
environment Bench for Main {{ y -> _ }}
"""


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("target", ["python", "c"])
def test_code_for_many_counting_iterations_is_that_for_a_few(target: str, level: int) -> None:
    some, many = (
        pipeline.generate(network(COUNTING.format(turns=turns), environment="Bench"), read_source, target, level)
        for turns in (MANY, 60_013)
    )
    shown = {name: text.replace("60013", str(MANY)) for name, text in many.items()}
    assert without_builds(shown) == without_builds(some)


TABLE = """
process Main {{
  out y : int
  communication {{ var table : int[{size}] = [{zeros}] }}
  composition {{ (seq i < {turns} : (table[i] := i + 1 ; y ! table[i])) }}
}}
environment Bench for Main {{ y -> _ }}
"""


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("missing", [0, 1])
def test_an_index_that_counts_is_tested_where_it_can_leave_an_array(level: int, missing: int) -> None:
    size = MANY - missing
    text = TABLE.format(turns=MANY, size=size, zeros=", ".join(["0"] * size))
    code = pipeline.generate(network(text, environment="Bench"), read_source, "c", level)["main_.c"]
    assert ("csp_index" in code, "csp_add" in code) == (missing == 1, False)


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
def test_code_for_many_iterations_is_that_for_a_few(target: str, level: int) -> None:
    some, many = (
        pipeline.generate(network(LAW.format(turns=turns), environment="Bench"), read_source, target, level)
        for turns in (SOME, 60_013)
    )
    shown = {name: text.replace("60013", str(SOME)) for name, text in many.items()}
    assert without_builds(shown) == without_builds(some)


def test_a_loop_is_one_step_of_the_network() -> None:
    made = network(LAW.format(turns=60_013))
    assert sum(1 for _ in parts(process(made, "Main"))) < 100
