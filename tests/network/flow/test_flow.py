"""Compositions as instructions with edges, and where they end."""

from __future__ import annotations

import pytest

from cspdiag.network.checks.endless import never_ends
from cspdiag.network.flow import code as flow
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Abandon, Code, Communicate, Delay, Join, Loop, Resume, Unwatch, following
from cspdiag.network.flow.ends import every_step_is_reached, may_end
from cspdiag.network.flow.raised import NO_EXCEPTIONS, exceptions_of
from cspdiag.network.flow.repetition import repeated_choices, repeated_classes
from cspdiag.network.flow.waiting import is_always_ready, only_computes
from cspdiag.network.ir.actions import Action, Choice
from cspdiag.network.ir.network import Network
from cspdiag.network.ir.walk import all_actions
from cspdiag.optimize import lower_for_targets, optimize
from tests.network import programs


def network_of_body(composition: str) -> Network:
    return programs.network(f"""
exception Odd
exception Even
process Main {{
  in u : int
  out y : int
  communication {{ var x : int = 0 }}
  composition {{ {composition} }}
}}
""")


def body(composition: str) -> Action:
    network = network_of_body(composition)
    found = programs.process(network, "Main").body
    assert found is not None
    return found


def code(composition: str) -> Code:
    return flow_of(body(composition))


def places(code: Code, kind: type) -> list[int]:
    return [index for index, instruction in enumerate(code.instructions) if isinstance(instruction, kind)]


@pytest.mark.parametrize(
    ("composition", "ends"),
    [
        ("u ? x", True),
        ("stop", False),
        ("mu u ? x", False),
        ("mu u ? x until x > 3", True),
        ("mu (u ? x ; stop) until x > 3", False),
        ("mu (if x > 3 then stop else u ? x) until x > 2", True),
        ("while x < 3 do stop", True),
        ("u ? x || stop", False),
        ("u ? x || y ! 1", True),
        ("if x > 3 then stop else mu u ? x", False),
        ("if x > 3 then stop else u ? x", True),
        ("(u ? x -> stop) [] (after 1 ms -> mu u ? x)", False),
        ("(u ? x -> stop) [] (after 1 ms -> y ! 1)", True),
        ("(mu u ? x) catch Timeout -> y ! 1", True),
        ("(mu u ? x) catch Timeout -> stop", False),
        ("(mu u ? x) interrupt after 1 ms -> skip", True),
        ("(mu u ? x) interrupt after 1 ms -> stop", False),
        ("raise Odd", False),
        ("seq i < 3 : (y ! i)", True),
    ],
)  # fmt: skip
def test_whether_a_composition_may_end(composition: str, ends: bool) -> None:
    assert may_end(body(composition)) == ends


@pytest.mark.parametrize(
    ("composition", "computes"),
    [
        ("x := 1", True),
        ("x := 1 ; (if x > 3 then raise Odd else x := 2)", True),
        ("while x < 3 do x := x + 1", True),
        ("(x := 1 ; raise Odd) catch Odd -> x := 2", True),
        ("(x := 1 ; raise Odd) catch Odd -> y ! 2", False),
        ("if x > 3 then u ? x else x := 2", False),
        ("wait 1 ms", False),
        ("stop", False),
        ("skip -> x := 1", False),
        ("(x := 1) interrupt after 1 ms -> skip", False),
        ("x := 1 ; (skip || skip)", False),
    ],
)  # fmt: skip
def test_whether_a_composition_does_nothing_but_compute(composition: str, computes: bool) -> None:
    assert only_computes(body(composition)) == computes


@pytest.mark.parametrize(
    ("guard", "kind", "ready"),
    [
        ("skip", "sync", True),
        ("u ? x", "sampled", False),
        ("u ? x", "overwrite", False),
        ("u ? x", "constant", True),
        ("u", "event", False),
        ("u", "var", True),
        ("y ! 1", "sync", False),
        ("y ! 1", "buffer", False),
        ("y ! 1", "overwrite", True),
        ("y ! 1", "latched", True),
        ("after 1 ms", "sync", False),
    ],
)  # fmt: skip
def test_which_guards_are_always_ready(guard: str, kind: str, ready: bool) -> None:
    (select,) = (step for step in all_actions(body(f"{guard} -> u ? x")) if isinstance(step, Choice))
    assert is_always_ready(select.branches[0].event, lambda _: kind) == ready


def test_a_time_out_of_zero_is_always_ready() -> None:
    (select,) = (step for step in all_actions(body("after 1 ms -> u ? x")) if isinstance(step, Choice))
    assert is_always_ready(select.branches[0].event, lambda _: "sync", lambda _: True)


def test_an_instance_that_never_ends_keeps_what_runs_it() -> None:
    network = programs.network("""
process Inner { in u : int  communication { var x : int }  composition { mu u ? x } }
process Main { in u : int  communication { inner : Inner  u -> inner.u }  composition { inner } }
""")
    main = programs.process(network, "Main").body
    assert main is not None
    assert may_end(main)
    assert not may_end(main, {"inner"})
    assert never_ends(network)
    assert never_ends(optimize(network)), "the same holds for a process that was flattened into another"


def test_an_edge_leads_to_the_handler_from_every_part_of_its_body() -> None:
    found = code("((u ? x ; y ! x) catch Timeout -> y ! 0) ; y ! 2")
    (abandon,) = places(found, Abandon)
    first, second, handler, after = places(found, Communicate)
    (ended,) = places(found, Unwatch)
    assert [found.abandoned[index] for index in (first, second, ended)] == [abandon] * 3
    assert [found.abandoned[index] for index in (abandon, handler, after)] == [None] * 3
    assert found.before[places(found, Resume)[0]] == (ended, handler)


def test_a_handler_inside_another_part_that_is_watched_may_be_abandoned_too() -> None:
    found = code("((u ? x catch Timeout -> y ! 0) catch Odd -> y ! 1)")
    inner, outer = places(found, Abandon)
    assert found.abandoned[inner] == outer
    assert found.abandoned[places(found, Communicate)[1]] == outer


def test_edges_lead_up_unless_they_close_a_loop() -> None:
    found = code("mu ((u ? x || y ! 1) ; while x > 3 do u ? x) until x > 7")
    for index, earlier in enumerate(found.before):
        for source in earlier:
            assert source < index or found.back[source] == index
    assert {type(found.instructions[loop]) for loop in found.back.values()} == {Loop}
    assert len(found.back) == 2
    assert len(found.before[places(found, Join)[0]]) == 2


@pytest.mark.parametrize(
    ("composition", "holds", "fails"),
    [
        ("(if x > 3 then u ? x else y ! 1) ; wait 1 ms", "ReadValue", "WriteValue"),
        ("mu ((while x > 3 do u ? x) ; y ! 1)", "ReadValue", "WriteValue"),
        ("mu u ? x until x > 3 ; y ! 1", "WriteValue", "ReadValue"),
        ("mu (wait 1 ms ; mu u ? x until x > 3)", "WaitStep", "ReadValue"),
        ("mu (wait 1 ms ; while x > 3 do u ? x)", "ReadValue", "WaitStep"),
    ],
)
def test_the_first_way_from_a_condition_is_where_it_holds(composition: str, holds: str, fails: str) -> None:
    found = code(composition)
    after = following(found)

    def next_step(index: int) -> str:
        instruction = found.instructions[index]
        if isinstance(instruction, Communicate | Delay):
            return type(instruction.step).__name__
        return next_step(after[index][0])

    (test,) = places(found, flow.Test)
    assert [next_step(way) for way in after[test]] == [holds, fails]


def test_every_condition_and_loop_knows_its_instructions() -> None:
    found = code("mu ((if x > 3 then while x > 5 do u ? x) ; y ! x)")
    kinds = [type(action).__name__ for action, _ in found.decisions]
    assert kinds == ["WhileLoop", "IfElse", "Repeat"], "what is inside comes first"
    inner, condition, outer = (inside for _, inside in found.decisions)
    assert set(inner) < set(condition) < set(outer)
    assert isinstance(found.instructions[inner.start], Loop)
    assert isinstance(found.instructions[condition.start], flow.Test)
    reads, writes = places(found, Communicate)
    assert reads in inner
    assert writes not in condition


@pytest.mark.parametrize(
    ("composition", "leaving", "coming"),
    [
        ("if x > 3 then raise Odd", {"Odd"}, []),
        ("(if x > 3 then raise Odd) catch Odd -> skip", set(), [({"Odd"}, set())]),
        ("(if x > 3 then raise Odd) catch Odd -> raise Even", {"Even"}, [({"Odd"}, set())]),
        ("(if x > 3 then raise Odd else raise Even) catch Odd -> skip", {"Even"}, [({"Odd", "Even"}, set())]),
        ("((if x > 3 then raise Odd) catch Odd -> skip) catch Odd -> skip", set(),
         [({"Odd"}, set()), (set(), {"Odd"})]),
        ("((if x > 3 then raise Odd) interrupt after 1 ms -> raise Even) catch Even -> skip", {"Odd"},
         [({"Odd", "Even"}, set())]),
        ("((u ? x || raise Odd) catch Odd -> raise Even) catch Even -> skip", set(),
         [({"Odd"}, set()), ({"Even"}, {"Odd"})]),
    ],
)  # fmt: skip
def test_which_exceptions_reach_handlers(composition: str, leaving: set[str], coming: list[object]) -> None:
    found, watched = exceptions_of(code(composition), lambda _: NO_EXCEPTIONS)
    assert found == leaving
    assert [(each.raised, each.caught_inside) for each in watched] == coming


GUARDED = "(u ? x -> skip [] after 1 ms -> skip)"


@pytest.mark.parametrize(
    ("composition", "again"),
    [
        (GUARDED, set()),
        (f"{GUARDED} ; {GUARDED}", set()),
        (f"mu ({GUARDED} ; y ! x)", {"choice"}),
        (f"mu ({GUARDED} ; y ! x) until x > 3", {"choice"}),
        (f"while x < 3 do {GUARDED} ; {GUARDED}", {"choice"}),
        (f"seq i < 1000 : {GUARDED}", {"choice"}),
        (f"(mu u ? x) interrupt after 3 ms -> {GUARDED}", set()),
        (f"mu ((u ? x catch Timeout -> {GUARDED}) ; y ! 1)", {"choice"}),
        (f"mu ({GUARDED} ; stop)", set()),
    ],
)
def test_which_alternatives_choose_again(composition: str, again: set[str]) -> None:
    network = lower_for_targets(network_of_body(composition))
    main = programs.process(network, "Main").body
    assert main is not None
    assert repeated_choices(main) == again


def test_what_runs_again_runs_what_is_inside_it_again() -> None:
    network = programs.network("""
process Leaf { in u : int  communication { var x : int }  composition { u ? x } }
process Both { in u : int  communication { one : Leaf  u -> one.u }  composition { one } }
process Once { in u : int  communication { var x : int }  composition { u ? x } }
process Main {
  in u : int
  communication { both : Both  once : Once  u -> both.u  u -> once.u }
  composition { once ; mu both }
}
""")
    assert repeated_classes(network) == {"Both", "Leaf"}


def test_a_loop_at_the_very_beginning_is_entered() -> None:
    looping = body("mu u ? x until x > 3")
    assert flow_of(looping).before[0] != (), "the only edge to the first instruction is that of the loop"
    assert may_end(looping)
    assert every_step_is_reached(body("mu (u ? x ; y ! x)"))
