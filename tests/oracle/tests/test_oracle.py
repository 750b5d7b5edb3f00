"""The oracle itself, on small programs whose answers are worked out by hand from docs/language.md."""

import pytest

from tests.oracle.hunt import hunt
from tests.oracle.judged import verify
from tests.oracle.page_run import page_run
from tests.oracle.programs.shrink import tidy
from tests.oracle.programs.text import text
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    After,
    Alt,
    Assign,
    Bin,
    Catch,
    Channel,
    Comp,
    Expr,
    Guarded,
    If,
    Int,
    Interrupt,
    Law,
    Lit,
    Mu,
    Par,
    Port,
    Program,
    Raise,
    Ready,
    Ref,
    Run,
    Seq,
    Skip,
    Stop,
    Target,
    Un,
    Variable,
    Wait,
    Write,
    early,
)  # fmt: skip
from tests.oracle.properties import decide
from tests.oracle.steps import O, read, write

SYNC = (Channel("c", INT, "sync"), Channel("d", INT, "sync"))
X = Port("x", True, INT, 10 * MS, values=((0, 0), (15 * MS, 1)), domain=(0,))
LAW = Law("a", (("x", INT, "x"),), (("y", INT, "v", Ref("x", INT)),), (), 1000, 0)


def number(value: int) -> Expr:
    return Lit(value, INT)


def program(body: Comp, *, channels: tuple[Channel, ...] = SYNC, laws: tuple[Law, ...] = ()) -> Program:
    variables = tuple(Variable(name, INT, 0, 0) for name in ("v", "w"))
    return Program(body, channels=channels, variables=variables, ports=(X, O), laws=laws, exceptions=("Alarm",))


def test_a_rendezvous_is_made_when_the_second_party_arrives() -> None:
    body = Par((Seq((Wait(2 * MS), write("c", 7))), Seq((read("c"), Write("o", Ref("v", INT))))))
    run = page_run(program(body), 20 * MS)
    assert (run.trace, run.ending) == ([(2 * MS, "c", 7), (2 * MS, "o", 7)], "terminated")


def test_a_writer_of_a_broadcast_continues_when_every_reader_has_the_value() -> None:
    channels = (Channel("c", INT, "broadcast"),)
    body = Par((Seq((write("c", 1), write("o", 5))), read("c"), Seq((Wait(3 * MS), read("c", "w")))))
    run = page_run(program(body, channels=channels), 20 * MS)
    assert run.trace == [(0, "c", 1), (3 * MS, "c", 1), (3 * MS, "o", 5)]


def test_an_overwriting_channel_drops_its_oldest_value() -> None:
    channels = (Channel("c", INT, "overwrite", 1),)
    body = Par((Seq((write("c", 1), write("c", 2))), Seq((Wait(MS), read("c"), Write("o", Ref("v", INT))))))
    assert page_run(program(body, channels=channels), 20 * MS).trace[-1] == (MS, "o", 2)


def test_a_fault_leaves_the_variable_as_it_was() -> None:
    small = Int("int8")
    ref = Ref("b", small)
    body = Catch(Assign(Target("b", small), Bin("+", ref, ref, small)), "Fault", Write("o", number(3)))
    made = Program(body, variables=(Variable("b", small, 100, 0),), ports=(O,))
    assert page_run(made, MS).trace == [(0, "o", 3)]


def test_an_interrupted_body_ends_at_its_next_communication() -> None:
    body = Interrupt(Seq((Wait(5 * MS), write("o", 1))), Guarded(After(2 * MS), write("o", 2)))
    assert page_run(program(body), 20 * MS).trace == [(2 * MS, "o", 2)]


def test_the_guard_of_an_interrupt_without_a_body_is_served_after_alternatives() -> None:
    lost = Interrupt(Stop(), Guarded(Write("c", number(2)), Skip()))
    later = Alt((Guarded(Write("c", number(3)), Skip()), Guarded(After(5 * MS), Skip())), False)
    reads = Seq((read("c"), Wait(2 * MS), read("c"), read("c")))
    body = Par((lost, Seq((Wait(MS), later)), reads, write("c", 1)))
    run = page_run(program(body, channels=(Channel("c", INT, "any"),)), 20 * MS)
    assert (run.trace, run.ending) == ([(0, "c", 1), (2 * MS, "c", 3), (2 * MS, "c", 2)], "terminated")


def test_interrupts_that_meet_cancel_both_bodies_and_the_first_without_one_chooses() -> None:
    first = Interrupt(Stop(), Guarded(write("c", 1), write("o", 1)))
    second = Interrupt(Stop(), Guarded(read("c"), write("o", 2)))
    assert page_run(program(Par((first, second))), MS).trace == [(0, "c", 1), (0, "o", 1), (0, "o", 2)]


def test_an_alternative_chooses_the_guard_of_an_interrupt_that_is_ready_at_once() -> None:
    """The guard is ready for the writer that waits plainly; the alternative, which has a higher priority,
    comes first.
    """
    chooses = Alt((Guarded(write("c", 1), write("o", 1)), Guarded(After(3 * MS), Skip())))
    reader = Interrupt(Seq((Wait(MS), write("o", 3))), Guarded(read("c"), write("o", 2)))
    body = Par((chooses, Seq((Wait(0), write("c", 7))), Seq((Wait(MS), reader))), prioritized=True)
    run = page_run(program(body, channels=(Channel("c", INT, "any"),)), 2 * MS)
    assert run.trace == [(MS, "c", 1), (MS, "o", 1), (MS, "o", 2)]


def test_an_exception_ends_the_other_branches_at_their_next_communication() -> None:
    body = Catch(Par((Seq((Wait(MS), Raise("Alarm"))), read("c"))), "Alarm", write("o", 4))
    assert page_run(program(body), 20 * MS).trace == [(MS, "o", 4)]


def test_a_first_read_waits_for_the_next_tick() -> None:
    body = Seq((Wait(12 * MS), read("x"), Write("o", Ref("v", INT))))
    assert page_run(program(body), 100 * MS).trace == [(20 * MS, "x", 1), (20 * MS, "o", 1)]


@pytest.mark.parametrize("between", [True, False])
def test_a_wait_between_two_loops_misses_samples(between: bool) -> None:
    once = Mu(Run("a"), Bin("==", number(0), number(0), INT))
    made = program(Seq((once, Wait(100 * MS if between else MS), Mu(Run("a")))), laws=(LAW,))
    assert decide(made, "schedulable").holds is not between


def test_a_law_that_computes_for_longer_than_its_period_misses_samples() -> None:
    made = program(Mu(Run("a")), laws=(Law(**{**vars(LAW), "wcet": 17 * MS}),))
    assert decide(made, "schedulable").holds is False


def test_a_sample_that_is_never_read_is_missed() -> None:
    over = Seq((Mu(Run("a"), Bin("==", number(0), number(0), INT)), Mu(Wait(3 * MS))))
    assert decide(program(over, laws=(LAW,)), "schedulable").holds is False


@pytest.mark.parametrize("what", ["livelock free", "terminates"])
def test_a_run_that_always_takes_the_same_guard_is_a_run(what: str) -> None:
    """As the page on proofs says, of both the oracle and the judged program."""
    one = Guarded(read("c"), Skip())
    other = Guarded(read("d"), Assign(Target("w", INT), number(1)))
    chooses = Mu(Alt((one, other)), Bin("==", Ref("w", INT), number(1), BOOL))
    made = program(Par((chooses, Mu(write("c", 1)), Mu(write("d", 1)))))
    assert decide(made, what).holds is False
    assert verify(text(tidy(made), what), seconds=60).verdict == "refuted"


def test_two_that_read_first_are_deadlocked() -> None:
    body = Par((Seq((read("c"), write("d", 1))), Seq((read("d", "w"), write("c", 1)))))
    assert decide(program(body), "deadlock free").holds is False


def test_a_pair_that_waits_for_each_other_next_to_a_loop_is_a_knot() -> None:
    stuck = (Mu(Seq((read("c"), write("d", 1)))), Mu(Seq((read("d", "w"), write("c", 1)))))
    assert decide(program(Par((*stuck, Mu(Wait(MS))))), "deadlock free").holds is False


def test_a_partner_that_waits_for_time_returns() -> None:
    """The device reads again after 3 ms, so the panel does not wait forever."""
    device = Seq((read("c"), Wait(3 * MS), read("c"), read("c")))
    late = Guarded(After(2 * MS), Seq((write("c", 0), write("c", 1))))
    panel = Seq((Alt((Guarded(write("c", 1), write("c", 9)), late)), write("c", 2)))
    beside = Mu(Wait(MS))
    assert decide(program(Par((device, panel, beside))), "deadlock free").holds is True


def test_waiting_for_a_partner_that_continues_elsewhere_is_not_a_knot() -> None:
    body = Par((Seq((write("c", 1), Mu(Wait(MS)))), Seq((read("c"), read("c")))))
    assert decide(program(body), "deadlock free").holds is None


def test_a_stopped_process_without_waiting_partners_is_not_a_knot() -> None:
    assert decide(program(Par((Stop(), Mu(Wait(MS))))), "deadlock free").holds is True


def test_a_pair_that_loops_without_time_livelocks() -> None:
    body = Par((Mu(write("c", 1)), Mu(read("c"))))
    assert decide(program(body), "livelock free").holds is False
    assert decide(program(Mu(write("o", 1))), "livelock free").holds is True


@pytest.mark.parametrize(("time", "ends"), [(2, True), (3, False)])
def test_a_program_terminates_if_every_run_ends(time: int, ends: bool) -> None:
    """With both time-outs due at once, one of the runs takes the second, after which nothing reads."""
    choice = Alt((Guarded(After(3 * MS), write("c", 1)), Guarded(After(time * MS), Skip())))
    assert decide(program(Par((choice, Skip()))), "terminates").holds is ends


def test_an_instant_stays_where_it_is_when_an_alternative_begins_anew() -> None:
    """`after 2 ms` is chosen twice, and then it is 5 ms; the writers of `o` show when."""
    at = Guarded(After(5 * MS, at=True), write("o", 1))
    turn = Alt((at, Guarded(After(2 * MS), write("o", 2))))
    body = Seq((turn, turn, turn, Wait(4 * MS, until=True), turn, Wait(7 * MS, until=True), write("o", 3)))
    run = page_run(program(body), 20 * MS)
    expected = [(2 * MS, "o", 2), (4 * MS, "o", 2), (5 * MS, "o", 1), (5 * MS, "o", 1), (7 * MS, "o", 3)]
    assert (run.trace, run.ending) == (expected, "terminated")


@pytest.mark.parametrize(("late", "holds"), [(3, True), (4, False)])
def test_states_are_distinguished_by_instants(late: int, holds: bool) -> None:
    """A loop reaches its place again at another instant: it never ends before 3 ms."""
    ends = Seq((Mu(Wait(MS), Un("not", early(3 * MS), BOOL)), If(early(late * MS), Stop())))
    assert decide(program(Par((ends, Mu(Wait(MS))))), "terminates").holds is False
    assert decide(program(ends), "terminates").holds is holds


def test_a_guard_that_is_a_port_leaves_the_sample_to_the_law() -> None:
    body = Mu(Alt((Guarded(After(50 * MS), Skip()), Guarded(Ready("x"), Run("a")))))
    assert decide(program(body, laws=(LAW,)), "schedulable").holds is True


@pytest.mark.parametrize(
    ("name", "first"),
    [("terminates", 2000), ("schedulable", 5000), ("refines", 100), ("trace", 3), ("deadlock", 900037)],
)
def test_a_slice_of_the_hunt_finds_nothing_wrong(name: str, first: int) -> None:
    """Of the last pair, the third program waits forever after a sum of 64 bits that overflows."""
    report = hunt(name, range(first, first + 5, 1 if name != "trace" else 2))
    assert not report.wrong, report.wrong[0][1].wrong
    assert report.counts["rejected"] < 3
