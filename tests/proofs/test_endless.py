"""Livelock and termination: which loops count, what they report, and when no search is needed."""

from __future__ import annotations

from itertools import count
from types import SimpleNamespace

import pytest

from cspdiag.proofs import verdict
from cspdiag.proofs.properties import cycles
from cspdiag.proofs.properties.livelock import livelock_free
from cspdiag.proofs.properties.termination import terminates
from cspdiag.proofs.transitions.systems.system import EventKind, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from tests.proofs.systems import known
from tests.proofs.systems.known import Machine, compose, cycle
from tests.proofs.systems.naive import layers, livelocked, replay
from tests.proofs.systems.random_networks import FORMS, Form, random_network


def chatter(kind: EventKind) -> System:
    """Two processes that communicate forever after a greeting, one of them with a third event in its loop."""
    one = Machine("one", {"first": [("greet", "talks")], "talks": [("talk", "looks")], "looks": [("look", "talks")]})
    other = Machine("other", {"first": [("greet", "talks")], "talks": [("talk", "talks")]})
    return compose([one, other], kinds={"look": kind})


@pytest.mark.parametrize("kind", ["external", "time", "sample", "miss"])
def test_a_loop_through_the_environment_or_time_is_not_a_livelock(kind: EventKind) -> None:
    verdict = livelock_free(chatter(kind), Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "rules"
    assert verdict.states is None


@pytest.mark.parametrize("kind", ["communication", "variable", "start"])
def test_an_invisible_loop_is_a_livelock(kind: EventKind) -> None:
    system = chatter(kind)
    verdict = livelock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert [str(system.events[move.event]) for move in verdict.trace] == ["greet"]
    assert [str(system.events[move.event]) for move in verdict.cycle] == ["talk", "look"]


def test_a_loop_with_a_visible_communication_is_not_a_livelock() -> None:
    assert isinstance(livelock_free(known.alternating_bit(), Limits()), Proved)
    hidden = compose([cycle("one", "a", "b"), cycle("other", "a", "b")])
    shown = compose([cycle("one", "a", "b"), cycle("other", "a", "b")], visible=["b"])
    assert isinstance(livelock_free(hidden, Limits()), Refuted)
    assert isinstance(livelock_free(shown, Limits()), Proved)


def test_a_loop_that_cannot_be_reached_needs_all_states() -> None:
    """Both could repeat together, but the third never lets them begin."""
    turns = [cycle(name, "turn", "back") for name in ("one", "other")]
    locked = [Machine(machine.name, {"before": [("open", "0")], **machine.table}) for machine in turns]
    system = compose([*locked, Machine("third", {"shut": [("knock", "shut")], "never": [("open", "never")]})])
    verdict = livelock_free(system, Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "breadth-first"
    assert verdict.states == 1


def test_thirty_philosophers_livelock_and_the_cycle_is_that_of_one() -> None:
    system = compose_hidden(known.philosophers(30))
    verdict = livelock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.cycle) == 6
    end = replay(system, verdict.trace)
    assert replay(system, verdict.trace + verdict.cycle) == end


def test_a_walk_with_those_that_moved_last_finds_the_cycle_of_a_pipeline_at_once() -> None:
    pipeline = compose(cycle(f"place{at}", f"pass{at}", f"pass{at + 1}") for at in range(40))
    verdict = terminates(pipeline, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) + len(verdict.cycle) <= 41


def test_a_livelock_of_very_many_components_is_found_in_their_only_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ring after a greeting of two of its members: what repeats is a round of all, and is found without a search."""
    ring = [Machine("head", {"new": [("greet", "0")], "0": [("pass0", "1")], "1": [("pass9", "0")]})]
    ring += [cycle(f"cell{at}", f"pass{at}", f"pass{at + 1}") for at in range(8)]
    ring += [Machine("last", {"new": [("greet", "0")], "0": [("pass8", "1")], "1": [("pass9", "0")]})]
    system = compose(ring)
    monkeypatch.setattr(cycles, "MANY", len(ring) - 1)
    verdict = livelock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.method == "rules"
    assert [str(system.events[move.event]) for move in verdict.trace] == ["greet"]
    assert sorted(str(system.events[move.event]) for move in verdict.cycle) == [f"pass{at}" for at in range(10)]
    monkeypatch.setattr(cycles, "MANY", len(ring))
    verdict = livelock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.method == "stubborn"


@pytest.mark.parametrize("form", FORMS)
def test_what_the_only_run_says_holds_for_small_networks(form: Form, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cycles, "MANY", 0)
    by_run = 0
    for seed in range(60):
        system = compose_hidden(random_network(seed, form=form, components=4))
        verdict = livelock_free(system, Limits())
        reached = [state for layer in layers(system) for state in layer]
        assert isinstance(verdict, Refuted) == any(livelocked(system, state) for state in reached), seed
        if isinstance(verdict, Refuted):
            end = replay(system, verdict.trace)
            assert livelocked(system, end)
            assert replay(system, verdict.trace + verdict.cycle) == end
            by_run += verdict.method == "rules"
    assert by_run or form not in {"cycles", "tokens"}


def compose_hidden(system: System) -> System:
    """The system with its external events hidden."""
    from cspdiag.base.record import replaced

    return replaced(system, events=tuple(replaced(event, kind="communication") for event in system.events))


def straight(name: str, *events: str, ends: bool = True) -> Machine:
    table = {str(at): [(event, str(at + 1))] for at, event in enumerate(events)} | {str(len(events)): []}
    return Machine(name, table, frozenset({str(len(events))} if ends else ()))


def test_processes_that_only_go_forward_terminate() -> None:
    verdict = terminates(compose([straight("one", "a", "b"), straight("other", "a", "b")]), Limits())
    assert isinstance(verdict, Proved)
    assert "no process can repeat" in verdict.reason


def test_a_loop_with_time_does_not_terminate() -> None:
    verdict = terminates(compose([cycle("timer", "tick")], kinds={"tick": "time"}), Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.cycle) == 1
    assert verdict.trace == ()


@pytest.mark.parametrize(
    "system",
    [
        compose([straight("one", "a", "b"), straight("other", "b", "a")]),
        compose([straight("one", "a", ends=False), straight("other", "a")]),
    ],
)
def test_processes_that_stop_before_their_end_do_not_terminate(system: System) -> None:
    verdict = terminates(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.stuck
    assert verdict.cycle == ()


@pytest.mark.parametrize("question", [livelock_free, terminates])
def test_a_question_that_reaches_a_limit_is_unknown(question: type) -> None:
    verdict = question(known.alternating_bit(lossy=False), Limits(seconds=0.0))
    assert isinstance(verdict, Proved | Unknown)
    verdict = question(compose_hidden(known.io_par_ring(10)), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason


@pytest.mark.parametrize("question", [livelock_free, terminates])
def test_the_clock_is_checked_repeatedly(question: type, monkeypatch: pytest.MonkeyPatch) -> None:
    # Every check of the time takes a second.
    monkeypatch.setattr(verdict, "time", SimpleNamespace(monotonic=count().__next__))
    answer = question(compose_hidden(known.io_par_ring(12)), Limits(seconds=100.0))
    assert isinstance(answer, Unknown)
    assert "time limit of 100 s" in answer.reason
