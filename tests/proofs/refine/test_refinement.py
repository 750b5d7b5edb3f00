"""Refinement in traces and in stable failures: known specifications, reported violations, and agreement with enumerated
traces and failures.
"""

from __future__ import annotations

from random import Random
from typing import TypeAlias

import pytest

from cspdiag.proofs.reduce import reduction
from cspdiag.proofs.refine import refinement
from cspdiag.proofs.refine.refinement import refines_in_failures, refines_in_traces
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown, Verdict
from tests.proofs.systems import known, naive
from tests.proofs.systems.known import Machine, compose, cycle

ONE_PLACE = compose([cycle("buffer", "accept", "deliver")], visible=["accept", "deliver"])


@pytest.fixture(autouse=True, params=[True, False], ids=["by vectors", "one by one"])
def vectors(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refinement, "has_vectors", lambda: request.param)


def words(system: System, verdict: Verdict) -> list[str]:
    assert isinstance(verdict, Refuted)
    naive.replay(system, verdict.trace)
    return [str(system.events[move.event]) for move in verdict.trace if move.event != INTERNAL
            and system.events[move.event].visible]  # fmt: skip


def test_the_alternating_bit_protocol_is_a_one_place_buffer() -> None:
    system = known.alternating_bit()
    for refines in (refines_in_traces, refines_in_failures):
        verdict = refines(system, ONE_PLACE, Limits())
        assert isinstance(verdict, Proved)
        assert verdict.states == 116


def test_a_protocol_that_deadlocks_keeps_the_traces_but_not_the_failures() -> None:
    system = known.alternating_bit(lossy=False)
    assert isinstance(refines_in_traces(system, ONE_PLACE, Limits()), Proved)
    verdict = refines_in_failures(system, ONE_PLACE, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) == 11
    assert verdict.reason == "it refuses `accept` and offers nothing, where the specification demands `accept`"


def test_two_places_are_too_many_for_a_one_place_buffer() -> None:
    system = compose(
        [cycle("front", "accept", "pass"), cycle("back", "pass", "deliver")], visible=["accept", "deliver"]
    )
    verdict = refines_in_traces(system, ONE_PLACE, Limits())
    assert words(system, verdict) == ["accept", "accept"]
    assert isinstance(verdict, Refuted)
    assert verdict.reason == "it does `accept`, where the specification allows only `deliver`"
    two = Machine(
        "two",
        {"0": [("accept", "1")], "1": [("accept", "2"), ("deliver", "0")], "2": [("deliver", "1")]},
    )
    specification = compose([two], visible=["accept", "deliver"])
    assert isinstance(refines_in_failures(system, specification, Limits()), Proved)


def test_a_choice_that_a_process_makes_itself_is_a_refusal() -> None:
    outside = compose([Machine("offers", {"0": [("a", "0"), ("b", "0")]})], visible=["a", "b"])
    inside = compose(
        [Machine("decides", {"0": [("tau", "1"), ("tau", "2")], "1": [("a", "0")], "2": [("b", "0")]})],
        visible=["a", "b"],
    )
    assert isinstance(refines_in_traces(inside, outside, Limits()), Proved)
    verdict = refines_in_failures(inside, outside, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.reason == "it refuses `b` and offers only `a`, where the specification demands `a` and `b`"
    assert isinstance(refines_in_failures(outside, inside, Limits()), Proved)


def test_hidden_ports_are_not_seen() -> None:
    system = compose([cycle("buffer", "accept", "log", "deliver")], visible=["accept", "log", "deliver"])
    assert isinstance(refines_in_traces(system, ONE_PLACE, Limits()), Refuted)
    assert isinstance(refines_in_failures(system, ONE_PLACE, Limits(), hidden=["log"]), Proved)


def test_an_end_where_the_specification_continues_is_a_violation() -> None:
    once = compose(
        [Machine("once", {"0": [("accept", "1")], "1": [("deliver", "2")], "2": []}, frozenset({"2"}))],
        visible=["accept", "deliver"],
    )
    verdict = refines_in_traces(once, ONE_PLACE, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.reason == "it ends, where the specification allows only `accept`"
    assert isinstance(refines_in_failures(once, once, Limits()), Proved)


def valued(*values: str | None) -> System:
    """A process that stops, and then writes these values again and again."""
    events = (Event("P.stop", (0,), "external", None, True), *(
        Event("P.out", (0,), "external", value, True) for value in values
    ))  # fmt: skip
    return System((Component("P", (((0, 1),), tuple((1 + at, 1) for at in range(len(values))))),), events)


def test_values_count_if_the_specification_distinguishes_them() -> None:
    only_zero, any_value = valued("0"), valued(None)
    assert isinstance(refines_in_traces(valued("0"), only_zero, Limits()), Proved)
    verdict = refines_in_traces(valued("0", "1"), only_zero, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.reason == "it does `out.1`, where the specification allows only `out.0`"
    assert isinstance(refines_in_failures(valued("0", "1"), any_value, Limits()), Proved)
    assert isinstance(refines_in_failures(any_value, any_value, Limits()), Proved)
    assert isinstance(refines_in_traces(any_value, only_zero, Limits()), Refuted), "an unknown value may be another"


def test_a_limit_leaves_the_question_open() -> None:
    verdict = refines_in_traces(known.alternating_bit(), ONE_PLACE, Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason


def buffers(number: int) -> System:
    """Single-place buffers in a row."""
    names = ["accept", *(f"pass{at}" for at in range(number - 1)), "deliver"]
    return compose(
        [cycle(f"place{at}", names[at], names[at + 1]) for at in range(number)], visible=["accept", "deliver"]
    )


def counter(most: int) -> System:
    """A buffer with this number of places."""
    table = {
        str(held): [("accept", str(held + 1))] * (held < most) + [("deliver", str(held - 1))] * (held > 0)
        for held in range(most + 1)
    }
    return compose([Machine("buffer", table)], visible=["accept", "deliver"])


def test_a_large_process_is_minimized_first() -> None:
    verdict = refines_in_failures(buffers(60), counter(60), Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "minimization"
    assert verdict.states == 61


def test_a_large_specification_is_minimized_first() -> None:
    assert isinstance(refines_in_failures(counter(60), buffers(60), Limits()), Proved)
    assert isinstance(refines_in_failures(counter(59), buffers(60), Limits()), Refuted)


def test_a_violation_of_a_large_process_has_a_trace_of_its_own() -> None:
    system = buffers(21)
    verdict = refines_in_traces(system, counter(1), Limits())
    assert words(system, verdict) == ["accept", "accept"]
    late = refines_in_traces(buffers(60), counter(59), Limits(seconds=3.0, memory=50_000_000))
    assert isinstance(late, Unknown)
    assert late.reason.startswith("there is a violation, but no trace to it was found: it does `accept`")


Failures: TypeAlias = set[tuple[tuple[str, ...], frozenset[str]]]

DEPTH = 5


def written_out(system: System) -> tuple[set[tuple[str, ...]], Failures]:
    """All traces of visible events up to a length, and what a stable state offers after each."""
    traces: set[tuple[str, ...]] = set()
    failures: Failures = set()
    seen = {((), system.initial)}
    pending: list[tuple[tuple[str, ...], naive.State]] = list(seen)
    while pending:
        trace, state = pending.pop()
        traces.add(trace)
        ways = [
            (
                system.events[move.event].channel
                if move.event != INTERNAL and system.events[move.event].visible
                else None,
                to,
            )
            for move, to in naive.steps(system, state)
        ]
        offered = frozenset(name for name, _ in ways if name is not None)
        if all(name is not None for name, _ in ways):
            ended = not ways and not naive.deadlocked(system, state)
            failures.add((trace, frozenset({"end"}) if ended else offered))
            if ended:
                traces.add((*trace, "end"))
        for name, after in ways:
            longer = trace if name is None else (*trace, name)
            if len(longer) <= DEPTH and (longer, after) not in seen:
                seen.add((longer, after))
                pending.append((longer, after))
    return traces, failures


def random_process(random: Random, names: list[str], parts: int) -> System:
    machines = []
    for at in range(parts):
        alphabet = [*names, "tau", *(["inner"] if parts > 1 else [])]
        states = random.randint(1, 3)
        table = {
            str(state): [
                (random.choice(alphabet), str(random.randrange(states))) for _ in range(random.choice((0, 1, 1, 2, 3)))
            ]
            for state in range(states)
        }
        ends = frozenset(state for state, edges in table.items() if not edges and random.random() < 0.7)
        machines.append(Machine(f"m{at}", table, ends))
    return compose(machines, visible=names)


@pytest.mark.parametrize(("failures", "large"), [(False, False), (True, False), (True, True)])
def test_refinement_is_inclusion_of_what_is_written_out(
    failures: bool, large: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reduction, "_WORTH_WHILE", 0 if large else 10**6)
    answers = []
    for seed in range(500):
        random = Random(seed)
        process = random_process(random, ["a", "b"], random.choice((1, 1, 2)))
        specification = process if seed % 10 == 0 else random_process(random, ["a", "b"], 1)
        refines = refines_in_failures if failures else refines_in_traces
        verdict = refines(process, specification, Limits())
        traces, refusals = written_out(process)
        allowed, offered = written_out(specification)
        holds = traces <= allowed
        if failures:
            holds = holds and all(
                any(trace == known_trace and accepted <= offers for known_trace, accepted in offered)
                for trace, offers in refusals
            )
        answers.append(holds)
        if not holds:
            assert isinstance(verdict, Refuted), f"seed {seed}"
            naive.replay(process, verdict.trace)
        elif isinstance(verdict, Refuted):
            assert len(words(process, verdict)) >= DEPTH, f"seed {seed}: {verdict.reason}"
    assert 75 < sum(answers) < 425, "both answers appear often"
