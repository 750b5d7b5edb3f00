"""Nested interrupts in the oracle: the meaning of guards that meet, worked out from the page, and the programs that
have them.
"""

from collections import Counter

import pytest

from tests.oracle.compare import program_of
from tests.oracle.hunt import hunt
from tests.oracle.page_run import page_run
from tests.oracle.programs.nested import guards_that_meet, is_nested, nested
from tests.oracle.programs.places import beside, ends, places
from tests.oracle.programs.tree import (
    INT,
    MS,
    After,
    Alt,
    Catch,
    Channel,
    Comp,
    Event,
    Guarded,
    Interrupt,
    Mu,
    Par,
    Program,
    Raise,
    Read,
    Seq,
    Skip,
    Stop,
    Variable,
    Wait,
    While,
    Write,
    walk,
)  # fmt: skip
from tests.oracle.properties import decide
from tests.oracle.steps import O, read, write

READS, WRITES = read("c"), write("c", 4)
LATE = After(MS)


def made(body: Comp, kind: str = "sync") -> Program:
    channels = (Channel("c", INT, kind, 1 if kind == "buffer" else 0), Channel("d", INT, "sync"))
    return Program(body, channels, tuple(Variable(name, INT, 0, 0) for name in "vw"), (O,), exceptions=("Alarm",))


def interrupted(body: Comp, event: Event, then: int | Comp) -> Interrupt:
    return Interrupt(body, Guarded(event, write("o", then) if isinstance(then, int) else then))


def outputs(body: Comp, kind: str = "sync") -> tuple[list[tuple[int, object]], str]:
    run = page_run(made(body, kind), 20 * MS)
    return [(time // MS, value) for time, channel, value in run.trace if channel == "o"], run.ending


INNER = interrupted(write("o", 5), WRITES, 6)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        # Each guard makes the other ready; the inner one is withdrawn, and the outer process waits for its own alone.
        (interrupted(interrupted(INNER, READS, 7), LATE, 8), [(1, 8)]),
        (interrupted(interrupted(interrupted(Wait(5 * MS), READS, 2), WRITES, 3), LATE, 9), [(1, 9)]),
        (interrupted(interrupted(interrupted(INNER, After(2 * MS), 7), READS, 1), After(3 * MS), 2), [(3, 2)]),
        # What is in between is cancelled too: a handler, and a branch that no longer raises anything.
        (interrupted(interrupted(Catch(INNER, "Alarm", write("o", 1)), READS, 2), LATE, 3), [(1, 3)]),
        (interrupted(interrupted(Par((INNER, Seq((Wait(MS), Raise("Alarm"))))), READS, 2), LATE, 3), [(1, 3)]),
        # The inner handler writes when the inner time-out is over: it makes the outer guard ready, and is withdrawn.
        (interrupted(interrupted(interrupted(Stop(), LATE, WRITES), READS, 1), After(2 * MS), 3), [(2, 3)]),
        # Two time-outs at one instant: the outer one withdraws the inner one.
        (interrupted(interrupted(Wait(5 * MS), LATE, 1), LATE, 2), [(1, 2)]),
        # The inner process waits for its guard alone when the outer guard is ready.
        (Par((interrupted(INNER, LATE, 1), Seq((Wait(2 * MS), write("d", 1))), read("d", "w"))), [(0, 5)]),
        # An iteration of a loop begins both guards again.
        (interrupted(Mu(interrupted(interrupted(Stop(), LATE, 1), LATE, 2)), After(2 * MS), 3), [(1, 2), (2, 3)]),
    ],
)  # fmt: skip
def test_guards_of_nested_interrupts(body: Comp, expected: list[tuple[int, object]]) -> None:
    assert outputs(body) == (expected, "terminated")


def test_a_body_that_makes_its_guard_ready_is_taken_back_from_there() -> None:
    """Its cancellation runs separately; there is no other reader, and the guard alone has no writer."""
    body = interrupted(Seq((WRITES, write("o", 1))), READS, 2)
    assert outputs(body) == ([], "deadlock")
    assert outputs(interrupted(body, LATE, 3)) == ([(1, 3)], "terminated")
    assert decide(made(body), "deadlock free").holds is False


def test_a_writer_that_was_taken_back_meets_nobody_later() -> None:
    """The reader of 1 ms finds no writer: that of the body was withdrawn at once."""
    body = Par((interrupted(Seq((WRITES, write("o", 1))), READS, 2), Seq((Wait(MS), read("c", "w")))))
    assert outputs(body, "any") == ([], "deadlock")
    assert decide(made(body, "any"), "terminates").holds is False


def test_a_value_put_into_a_buffer_is_there_for_the_guard_that_it_made_ready() -> None:
    body = interrupted(Seq((WRITES, write("o", 1))), READS, 2)
    assert outputs(body, "buffer") == ([(0, 2)], "terminated")


def test_an_alternative_in_a_body_chooses_the_guard_around_it_and_ends_at_its_next_place() -> None:
    chooses = Alt((Guarded(WRITES, write("o", 1)), Guarded(LATE, Skip())))
    assert outputs(interrupted(chooses, READS, 2)) == ([(0, 2)], "terminated")


def test_crossing_guards_of_two_nests_meet_once() -> None:
    """Both outer guards and both inner ones could meet; the last guard to begin finds its partner first."""
    left = interrupted(interrupted(Stop(), READS, 1), write("d", 4), 2)
    right = interrupted(interrupted(Stop(), read("d", "w"), Skip()), WRITES, Skip())
    run = page_run(made(Par((left, right))), 20 * MS)
    assert (run.trace, run.ending) == ([(0, "c", 4), (0, "o", 1)], "terminated")


def test_the_guard_of_a_body_that_has_failed_is_withdrawn_at_once() -> None:
    """At 1 ms the body fails first; the alternative, which runs before the handler, finds no guard."""
    fails = Catch(interrupted(Seq((Wait(MS), Raise("Alarm"))), READS, 1), "Alarm", write("o", 2))
    chooses = Alt((Guarded(WRITES, Skip()), Guarded(After(2 * MS), Skip())))
    body = Par((fails, Seq((Wait(MS // 2), Wait(MS // 2), chooses))))
    run = page_run(made(body), 20 * MS)
    assert (run.trace, run.ending) == ([(MS, "o", 2)], "terminated")


# ---- the programs ----


def test_one_program_in_five_has_nested_interrupts_of_many_forms() -> None:
    seeds = [seed for seed in range(500) if is_nested(seed)]
    assert 80 < len(seeds) < 120
    programs = [program_of(seed, inputs=seed % 3 == 0) for seed in seeds]
    assert sum(guards_that_meet(program) > 0 for program in programs) > 0.4 * len(programs)
    inner = Counter(type(part) for program in programs for part in _inside_interrupts(program))
    assert inner.keys() >= {Interrupt, Catch, Raise, Par, Alt, Mu, While, Read, Write, Wait}
    assert inner[Interrupt] > len(programs)
    assert {channel.kind for program in programs for channel in program.channels} >= {"sync", "any", "buffer"}
    assert any(program.boxed for program in programs)


def _inside_interrupts(program: Program) -> list[Comp]:
    return [inner for part in walk(program.body) if isinstance(part, Interrupt) for inner in walk(part.body)]


def test_ends_of_a_channel_are_in_parallel_parts() -> None:
    for seed in range(60):
        found = places(nested(seed).body)
        for one in found:
            for other in found:
                (here, there) = ends(one.part), ends(other.part)
                if here and there and here[0] == there[0] and here[1] != there[1]:
                    assert beside(one, other, found)


@pytest.mark.parametrize("name", ["deadlock", "terminates", "refines", "trace"])
def test_a_slice_of_the_hunt_in_nested_interrupts_finds_nothing_wrong(name: str) -> None:
    report = hunt(name, iter([seed for seed in range(60) if is_nested(seed)][:5]))
    assert not report.wrong, report.wrong[0][1].wrong
    assert report.counts["nested"] == 5
    assert report.counts["rejected"] < 2
