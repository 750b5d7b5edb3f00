"""The present instant in the oracle: what programs do with it, and how much of the clock their states contain."""

from random import Random

import pytest

from tests.oracle.compare import program_of
from tests.oracle.hunt import hunt
from tests.oracle.machine.horizon import BEYOND, Horizon, horizon
from tests.oracle.page_run import page_run
from tests.oracle.programs.instants import single_steps, uses_the_time, with_instants, with_knot
from tests.oracle.programs.shrink import tidy
from tests.oracle.programs.text import expression
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    TIME,
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
    If3,
    Lit,
    Mu,
    Now,
    Par,
    Port,
    Program,
    Raise,
    Read,
    Ref,
    Seq,
    Skip,
    Stop,
    Target,
    Variable,
    Wait,
    While,
    Write,
    early,
    walk,
)  # fmt: skip
from tests.oracle.properties import decide
from tests.oracle.steps import O, read, write

X = Port("x", True, INT, 2 * MS, values=((0, 0),), domain=(0,))
T, S = Ref("t", TIME), Ref("s", TIME)
KEEP = Assign(Target("t", TIME), Now())
LATE = Bin(">", Now(), Lit(3 * MS, TIME), BOOL)
AGE = Bin("-", Now(), T, TIME)
STEP = Wait(MS)


def time(milliseconds: int) -> Lit:
    return Lit(milliseconds * MS, TIME)


def made(body: Comp, kind: str = "sync") -> Program:
    variables = (
        *(Variable(name, TIME, 0, 0) for name in "ts"),
        *(Variable(name, INT, 0, 0) for name in "vw"),
        Variable("b", BOOL, False, 0),
    )
    channels = (Channel("c", TIME, kind, 0 if kind == "sync" else 1),)
    return Program(body, channels, variables, (X, O), exceptions=("Late",))


def at_4_ms() -> Expr:
    return If3(Bin("==", Now(), time(4), BOOL), Lit(0, INT), Lit(1, INT), INT)


ENDING: list[tuple[Comp, int]] = [
    (While(early(3 * MS), STEP), 3),
    (Mu(STEP, LATE), 4),
    (Mu(STEP, Bin("<", time(3), Now(), BOOL)), 4),
    (Mu(STEP, Bin("==", Now(), time(3), BOOL)), 3),
    (Mu(Seq((read("x"), write("o", 1))), Bin(">=", Now(), time(5), BOOL)), 6),
    (Catch(Mu(Seq((STEP, If(LATE, Raise("Late"))))), "Late", Skip()), 4),
    (Mu(Seq((STEP, Assign(Target("b", BOOL), LATE))), Ref("b", BOOL)), 4),
    (Catch(Mu(Seq((STEP, Assign(Target("v", INT), Bin("/", Lit(6, INT), at_4_ms(), INT))))), "Fault", Skip()), 4),
    (
        Mu(
            Alt((Guarded(Skip(), Assign(Target("b", BOOL), Lit(True, BOOL)), LATE), Guarded(After(MS), Skip())), True),
            Ref("b", BOOL),
        ),
        4,
    ),
    (Seq((STEP, KEEP, Mu(STEP, Bin(">", AGE, time(2), BOOL)))), 4),
    (Seq((STEP, KEEP, Mu(STEP, Bin(">=", Now(), Bin("+", T, time(2), TIME), BOOL)))), 3),
    (Seq((KEEP, STEP, Wait(Bin("+", T, time(3), TIME), True))), 3),
    (Par((Seq((STEP, Write("c", Now()))), Seq((Read("c", Target("t", TIME)), If(LATE, Stop()))))), 1),
]


@pytest.mark.parametrize(("body", "ends"), ENDING)
def test_the_present_instant_ends_a_program(body: Comp, ends: int) -> None:
    run = page_run(made(body), 20 * MS)
    assert (run.ending, run.time) == ("terminated", ends * MS)
    assert decide(made(body), "terminates").holds is True


@pytest.mark.parametrize(
    "body",
    [
        Mu(Wait(2 * MS), Bin("==", Now(), time(3), BOOL)),
        Mu(Seq((KEEP, STEP)), Bin(">", AGE, time(2), BOOL)),
        Par((Mu(Seq((KEEP, Write("c", T), Wait(2 * MS)))), Mu(Seq((Read("c", Target("s", TIME)), STEP))))),
        Seq((KEEP, Mu(STEP, Bin("and", LATE, Bin("<=", AGE, time(3), BOOL), BOOL)))),
        Mu(Seq((KEEP, Wait(2 * MS), Wait(Bin("+", T, time(5), TIME), True))), Bin("==", AGE, time(4), BOOL)),
        Seq((Mu(STEP, LATE), If(LATE, Stop()))),
    ],
)
def test_loops_that_the_present_instant_does_not_end_continue(body: Comp) -> None:
    """Even if times are kept: only their ages make a difference."""
    assert decide(made(body), "terminates").holds is False


def test_ages_that_are_distinguished_are_those_that_are_compared() -> None:
    """The writer is lost if the reader stops at a time that is 2 ms old, as every time is when it is read."""
    for age, free in ((2, False), (3, True)):
        stops_at_age = Seq((Read("c", Target("t", TIME)), If(Bin("==", AGE, time(age), BOOL), Stop())))
        body = Par((Mu(Seq((Write("c", Now()), Wait(2 * MS)))), Mu(Seq((Wait(2 * MS), stops_at_age)))))
        assert decide(made(body, "buffer"), "deadlock free").holds is free


@pytest.mark.parametrize(
    ("body", "instant", "age"),
    [
        (Mu(STEP), 0, 0),
        (Wait(3 * MS, until=True), 3 * MS, 0),
        (Mu(STEP, LATE), 3 * MS + 1, 0),
        (Mu(Seq((KEEP, STEP))), 0, 0),
        (Seq((KEEP, Mu(STEP, Bin(">", AGE, time(2), BOOL)))), 0, 2 * MS + 1),
        (Seq((KEEP, Mu(STEP, Bin(">", time(7), T, BOOL)))), 7 * MS + 1, 0),
        (Seq((KEEP, Wait(Bin("+", T, time(2), TIME), True))), 0, 2 * MS + 1),
        (Assign(Target("v", INT), If3(LATE, Lit(1, INT), Lit(2, INT), INT)), 3 * MS + 1, 0),
        (Seq((KEEP, Wait(AGE))), BEYOND, BEYOND),
        (Seq((KEEP, Assign(Target("t", TIME), Bin("+", T, time(1), TIME)))), BEYOND, BEYOND),
        (Seq((KEEP, Assign(Target("s", TIME), Now()), If(Bin("<", T, S, BOOL), Skip()))), BEYOND, BEYOND),
        (Seq((KEEP, If(Bin("<", Bin("*", T, Lit(2, INT), TIME), time(3), BOOL), Skip()))), BEYOND, BEYOND),
        (If(Bin("<", Bin("+", Now(), Lit(2**63 - 1, TIME), TIME), time(3), BOOL), Skip()), BEYOND, BEYOND),
        (Wait(T, until=True), BEYOND, BEYOND),
    ],
)
def test_how_far_the_clock_counts(body: Comp, instant: int, age: int) -> None:
    found = horizon(made(body))
    assert (found.instant, found.age) == (instant, age)


def test_nothing_is_reported_while_the_clock_advances() -> None:
    paced = Seq((Assign(Target("t", TIME), Bin("+", T, time(2), TIME)), Wait(T, until=True)))
    answer = decide(made(Seq((KEEP, Mu(paced)))), "deadlock free", limit=200)
    assert answer.holds is None
    assert answer.why == "its states hold the clock, which advances"
    assert decide(made(Seq((KEEP, Mu(paced, LATE)))), "terminates").holds is True


def test_states_with_less_of_the_clock_give_the_answers_of_full_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The numbers of random programs whose states end and do not end."""
    programs = [tidy(with_instants(single_steps(Random(seed)), Random(seed))) for seed in range(30)]
    bounded = [decide(program, "terminates", limit=250) for program in programs]
    assert sum(answer.holds is not None for answer in bounded) > 25
    whole = Horizon(BEYOND, BEYOND, frozenset())
    monkeypatch.setattr("tests.oracle.machine.clock.horizon", lambda program: whole)
    exact = [decide(program, "terminates", limit=250) for program in programs]
    pairs = [(a.holds, b.holds) for a, b in zip(bounded, exact, strict=True) if None not in (a.holds, b.holds)]
    assert len(pairs) > 10
    assert all(a == b for a, b in pairs)


# ---- the programs ----


def test_the_present_instant_is_written_as_now() -> None:
    assert expression(Bin("<=", AGE, time(2), BOOL)) == "((now - t) <= 2 ms)"


def test_one_program_in_six_uses_the_time_in_many_ways() -> None:
    asking = [seed for seed in range(600) if uses_the_time(seed)]
    assert 80 < len(asking) < 120
    programs = [program_of(seed, inputs=seed % 3 == 0) for seed in asking]
    forms = {type(part) for program in programs for part in walk(program.body) if "Now" in repr(part)}
    assert forms >= {Mu, While, If, Assign, Write, Guarded, Wait, Catch, Alt, Par, Seq}
    assert any(channel.type == TIME for program in programs for channel in program.channels)
    bounded = [horizon(program).bounded for program in programs]
    assert sum(bounded) > 0.9 * len(bounded)


def test_only_what_ends_all_others_ends_a_knot() -> None:
    raises = Mu(Seq((STEP, If(LATE, Raise("Late")))))
    assert page_run(with_knot(made(raises)), 20 * MS).time == 4 * MS
    assert decide(with_knot(made(raises)), "terminates").holds is True
    assert decide(with_knot(made(Catch(raises, "Late", Skip()))), "terminates").holds is False


def test_programs_that_the_present_instant_ends_are_not_taken_for_endless() -> None:
    report = hunt("terminates", iter([355, 1005, 1010, 1243, 1418, 1646, 1919]))
    assert not report.wrong, report.wrong[0][1].wrong
    assert report.counts["now"] == 7
    assert not report.counts["rejected"]


def test_the_end_of_a_run_is_read_from_its_report() -> None:
    """The first ends with an exception of its own, after a warning; the second ends with that instead of a fault."""
    report = hunt("trace", iter([283, 188]))
    assert not report.wrong, report.wrong[0][1].wrong
    assert report.counts["now"] == 2
