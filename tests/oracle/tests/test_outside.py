"""What comes from outside, refinement, and guards of broadcasts in the oracle: answers worked out by hand from the
pages.
"""

import pytest

from tests.oracle.page_run import page_run
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    REAL,
    After,
    Alt,
    Assign,
    Bin,
    Catch,
    Channel,
    Comp,
    Guarded,
    Interrupt,
    Lit,
    Mu,
    Par,
    Port,
    Program,
    Read,
    Ref,
    Seq,
    Skip,
    Stop,
    Target,
    Variable,
    Wait,
    Write,
)  # fmt: skip
from tests.oracle.properties import decide
from tests.oracle.refine import refines
from tests.oracle.steps import O, read, write

E = Port("e", True, BOOL, domain=(False, True), values=((0, False),))
F = Port("f", True, BOOL, domain=(False, True), values=((0, False),))
X = Port("x", True, INT, 10 * MS, values=((0, 0),), domain=(0,))
H = Port("h", False, INT)


def made(body: Comp, *ports: Port, channels: tuple[Channel, ...] = ()) -> Program:
    numbers = tuple(Variable(name, INT, 0, 0) for name in ("v", "w"))
    return Program(body, channels, (*numbers, Variable("b", BOOL, False, 0), Variable("r", REAL, 1.0, 0)), (*ports, O))


def event(port: str) -> Read:
    return Read(port, Target("b", BOOL))


# ---- what comes from outside ----


def test_waiting_for_an_event_is_not_a_deadlock_because_it_occurs_eventually() -> None:
    assert decide(made(event("e"), E), "deadlock free").holds is True
    assert decide(made(event("e"), E), "terminates").holds is True
    assert decide(made(Mu(event("e")), E), "terminates").holds is False


def test_an_event_may_arrive_while_a_process_runs() -> None:
    """The second event is there when the process checks for it, although it has not waited since the first."""
    again = Alt((Guarded(event("e"), read("c", "v")), Guarded(Skip(), Skip())), prioritized=True)
    program = made(Seq((event("e"), write("o", 1), again)), E, channels=(Channel("c", INT, "sync"),))
    assert decide(program, "deadlock free").holds is False


def test_parts_in_sequence_share_the_session_of_an_input() -> None:
    """`wait 12 ms || x ? v`, and then `x ? w`: the second read finds that the sample of 10 ms has been taken, and waits
    for the next.
    """
    body = Seq((Par((Wait(12 * MS), read("x", "v"))), read("x", "w"), write("o", 1)))
    assert page_run(made(body, X), 100 * MS).trace == [(10 * MS, "x", 0), (20 * MS, "x", 0), (20 * MS, "o", 1)]


def test_the_guard_of_an_interrupt_follows_its_input_from_the_start() -> None:
    body = Interrupt(Wait(50 * MS), Guarded(read("x", "v"), write("o", 1)))
    assert page_run(made(body, X), 100 * MS).trace == [(10 * MS, "x", 0), (10 * MS, "o", 1)]


# ---- broadcasts in guards ----


@pytest.mark.parametrize(("late", "reported"), [(0, True), (3, False)])
def test_a_guard_that_writes_a_broadcast_waits_for_every_end(late: int, reported: bool) -> None:
    writer = Alt((Guarded(write("c", 7), Skip()), Guarded(After(2 * MS), write("o", 9))))
    guard = Alt((Guarded(read("c", "v"), Skip()), Guarded(After(4 * MS), Skip())))
    reader = Seq((Wait(late * MS), Alt((Guarded(read("c", "w"), Skip()), Guarded(After(MS), Skip())))))
    run = page_run(made(Par((writer, guard, reader)), channels=(Channel("c", INT, "broadcast"),)), 20 * MS)
    assert run.trace == ([(0, "c", 7), (0, "c", 7)] if reported else [(2 * MS, "o", 9)])


# ---- doubles ----


def test_an_infinite_real_is_a_fault_where_it_is_stored() -> None:
    huge = Bin("*", Lit(1e300, REAL), Lit(1e300, REAL), REAL)
    inside = Bin("<", Lit(1.0, REAL), huge, BOOL)
    body = Catch(
        Seq((Assign(Target("b", BOOL), inside), write("o", 1), Assign(Target("r", REAL), huge))),
        "Fault",
        Alt((Guarded(write("o", 2), Skip(), Bin("==", Ref("r", REAL), Lit(1.0, REAL), BOOL)),)),
    )
    assert page_run(made(body), MS).trace == [(0, "o", 1), (0, "o", 2)]


# ---- refinement ----


def both() -> Comp:
    return Alt((Guarded(event("e"), Skip()), Guarded(event("f"), Skip())))


def either() -> Comp:
    return Alt((Guarded(Skip(), event("e")), Guarded(Skip(), event("f"))))


def test_failures_show_refusals_and_traces_do_not() -> None:
    offers, chooses = made(both(), E, F), made(either(), E, F)
    assert refines(chooses, offers).holds is True
    assert refines(chooses, offers, failures=True).holds is False
    assert refines(offers, offers, failures=True).holds is True
    assert refines(offers, chooses, failures=True).holds is True


def test_the_end_is_visible() -> None:
    assert refines(made(event("e"), E), made(Mu(event("e")), E)).holds is False
    assert refines(made(Skip()), made(Stop())).holds is False
    assert refines(made(Stop()), made(Skip())).holds is True
    assert refines(made(Stop()), made(Skip()), failures=True).holds is False


def test_ports_that_the_specification_does_not_have_are_hidden() -> None:
    shown = made(Seq((Write("h", Lit(1, INT)), write("o", 2))), H)
    assert refines(shown, made(write("o", 2))).holds is True
    assert refines(shown, made(write("o", 3))).holds is False
