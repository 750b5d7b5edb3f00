"""Design rules: each form of network is proved by its rule, under its name; and no rule proves what fails."""

from __future__ import annotations

import pytest

from cspdiag.proofs.rules.deadlock import by_rules
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown, Verdict
from tests.proofs.systems import known, naive
from tests.proofs.systems.known import Machine, compose, cycle
from tests.proofs.systems.random_networks import FORMS, Form, plain_knot, random_network, truth


def ruled(system: System, *, together: bool) -> Verdict:
    return by_rules(StuckQuestion(system, together), Limits())


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
@pytest.mark.parametrize(
    ("system", "rule"),
    [
        (known.io_par_ring(6), "I/O-PAR"),
        (known.client_server_chain(5), "client-server network without circles: `p4`, `p3`, `p2`, `p1`, `p0`"),
        (known.philosophers(5, left_handed=1), "takes its resources in one order"),
        (known.milner(6), "no process has a choice, and the only run repeats itself after"),
        (known.controller(2), "each process waits only for those before it, in the order: "),
    ],
    ids=["I/O-PAR", "client-server", "resources", "one run", "order"],
)
def test_a_network_is_proved_by_the_rule_that_it_keeps(system: System, rule: str, together: bool) -> None:
    verdict = ruled(system, together=together)
    assert isinstance(verdict, Proved)
    assert rule in verdict.reason


def test_resources_are_listed_in_the_order_in_which_they_are_taken() -> None:
    takes = [("a", "b"), ("b", "c")]
    users = [
        cycle(f"user{at}", f"take {one}{at}", f"take {two}{at}", f"give {two}{at}", f"give {one}{at}")
        for at, (one, two) in enumerate(takes)
    ]
    resources = []
    for name in ("c", "a", "b"):
        takers = [at for at, needed in enumerate(takes) if name in needed]
        free = {"free": [(f"take {name}{at}", f"with {at}") for at in takers]}
        resources.append(Machine(name, free | {f"with {at}": [(f"give {name}{at}", "free")] for at in takers}))
    verdict = ruled(compose([*users, *resources]), together=False)
    assert isinstance(verdict, Proved)
    assert verdict.reason == "every process takes its resources in one order: `a`, `b`, `c`"


def test_processes_that_all_write_before_they_read_are_refuted_by_their_only_run() -> None:
    for together in (True, False):
        verdict = ruled(known.io_seq_ring(4), together=together)
        assert isinstance(verdict, Refuted)
        assert verdict.trace == ()
        assert len(verdict.stuck) == 4


def test_one_that_shares_in_parallel_saves_a_ring_of_sequential_ones() -> None:
    ring = [cycle(f"node{at}", f"c{at + 1}", f"c{at}") for at in range(3)]
    both = {"both": [("c3", "writes"), ("c0", "reads")], "writes": [("c0", "both")], "reads": [("c3", "both")]}
    verdict = ruled(compose([*ring, Machine("parallel", both)]), together=False)
    assert isinstance(verdict, Proved)
    assert "no process has a choice" in verdict.reason


def test_philosophers_of_one_hand_are_left_to_other_methods() -> None:
    verdict = ruled(known.philosophers(3), together=True)
    assert isinstance(verdict, Unknown)
    assert "`fork0` has an alternative" in verdict.reason


def test_a_process_that_always_continues_is_named() -> None:
    verdict = ruled(known.with_loop(known.philosophers(3)), together=True)
    assert isinstance(verdict, Proved)
    assert verdict.reason == "`loop asker`, `loop answerer` can always continue"


@pytest.mark.parametrize("form", FORMS)
def test_rules_are_right_about_random_networks(form: Form) -> None:
    answered = 0
    for seed in range(1000, 1150):
        system = random_network(seed, form=form)
        facts = truth(system)
        assert facts is not None
        for together, fails in ((True, facts.deadlock), (False, facts.knot)):
            verdict = ruled(system, together=together)
            answered += not isinstance(verdict, Unknown)
            assert not (isinstance(verdict, Proved) and fails), seed
            if isinstance(verdict, Refuted):
                assert fails, seed
                end = naive.replay(system, verdict.trace)
                assert naive.deadlocked(system, end) if together else plain_knot(system, end)
    assert answered > 50
