"""Arithmetic at the ends of the ranges in the oracle: what faults and what just avoids a fault, worked out by hand from
the section Faults of docs/language.md.
"""

import pytest

from tests.oracle.machine.values import FaultError, evaluate
from tests.oracle.page_run import page_run
from tests.oracle.programs.text import definitions, literal
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    REAL,
    TIME,
    After,
    Alt,
    Assign,
    Bin,
    Catch,
    Channel,
    Comp,
    Convert,
    Expr,
    Guarded,
    Int,
    Law,
    Lit,
    Mu,
    Par,
    Program,
    Read,
    Ref,
    Run,
    Seq,
    Skip,
    Stop,
    Target,
    Un,
    Value,
    Variable,
    Wait,
    Write,
)  # fmt: skip
from tests.oracle.properties import decide
from tests.oracle.steps import O, read, write

LEAST, MOST = -(2**63), 2**63 - 1
INT8, INT32, UINT8, UINT32 = (Int(name) for name in ("int8", "int32", "uint8", "uint32"))
SYNC = (Channel("c", INT, "sync"),)


def of(kind: Int, a: int, op: str, b: int) -> Expr:
    return Bin(op, Lit(a, kind), Lit(b, kind), kind)


def made(body: Comp, first: int = 0, kind: Int = INT, laws: tuple[Law, ...] = ()) -> Program:
    """`v` is the variable under test, `w` another one."""
    return Program(body, SYNC, (Variable("v", kind, first, 0), Variable("w", kind, 0, 0)), (O,), laws)


@pytest.mark.parametrize(
    ("expr", "value"),
    [
        (of(INT, MOST - 1, "+", 1), MOST),
        (of(INT, LEAST + 1, "-", 1), LEAST),
        (of(INT, LEAST, "+", MOST), -1),
        (of(INT, -(2**62), "*", 2), LEAST),
        (of(INT, 3037000499, "*", 3037000499), 3037000499**2),
        (of(INT, -2, "^", 63), LEAST),
        (of(INT, -1, "^", MOST), -1),
        (of(INT, 0, "^", MOST), 0),
        (of(INT, LEAST, "%", -1), 0),
        (of(INT, LEAST, "/", 2), -(2**62)),
        (of(TIME, MOST - 5, "+", 5), MOST),
        (of(INT8, 100, "+", 27), 127),
        (of(UINT8, 16, "*", 15), 240),
        (of(UINT32, 2**32 - 1, "-", 2**32 - 1), 0),
        (Un("-", Lit(MOST, INT), INT), LEAST + 1),
        (Convert(Lit(-(2.0**63), REAL), INT), LEAST),
        (Convert(Lit(127.9, REAL), INT8), 127),
        (Convert(Lit(-0.9, REAL), UINT8), 0),
        (Convert(Lit(MOST, INT), REAL), 2.0**63),
    ],
)
def test_what_is_just_within_its_range_is_exact(expr: Expr, value: Value) -> None:
    assert evaluate(expr, {}) == value


@pytest.mark.parametrize(
    "expr",
    [
        of(INT, MOST, "+", 1),
        of(INT, LEAST, "-", 1),
        of(INT, LEAST, "*", -1),
        of(INT, LEAST, "/", -1),
        of(INT, 3037000500, "*", 3037000500),
        of(INT, 2, "^", 63),
        of(INT, 10, "^", MOST),
        of(INT, 2, "^", -1),
        of(INT, 1, "%", 0),
        Bin("-", of(INT, MOST, "+", 1), Lit(1, INT), INT),
        of(TIME, 9223372036 * 10**9, "+", 855 * MS),
        of(INT8, 64, "+", 64),
        of(INT8, -128, "/", -1),
        of(UINT8, 0, "-", 1),
        of(INT32, 2**16, "*", 2**15),
        Un("-", Lit(LEAST, INT), INT),
        Un("abs", Lit(LEAST, INT), INT),
        Un("abs", Lit(-128, INT8), INT8),
        Convert(Lit(2.0**63, REAL), INT),
        Convert(Lit(128, INT), INT8),
        Convert(Lit(-1, INT), UINT32),
        Convert(Bin("*", Lit(1e300, REAL), Lit(1e300, REAL), REAL), INT),
    ],
)
def test_what_is_just_beyond_its_range_is_a_fault(expr: Expr) -> None:
    with pytest.raises(FaultError):
        evaluate(expr, {})


def test_numbers_at_the_ends_are_written_with_numbers_of_their_types() -> None:
    assert literal(LEAST, INT) == "((-9223372036854775807) - 1)"
    assert literal(LEAST, TIME) == "((-9223372036854775807 ns) - 1 ns)"
    body = Assign(Target("v", INT), Lit(LEAST, INT, constant=True))
    assert f"const k5 : int = {literal(LEAST, INT)}" in definitions(made(body))


@pytest.mark.parametrize(("initial", "ends"), [(MOST - 3, True), (MOST - 2, False)])
def test_a_sum_that_faults_leads_to_its_handler(initial: int, ends: bool) -> None:
    adds = Assign(Target("v", INT), Bin("+", Ref("v", INT), Lit(3, INT), INT))
    body = Catch(adds, "Fault", Stop())
    assert decide(made(body, initial), "terminates").holds is ends


@pytest.mark.parametrize(("received", "holds"), [(1, True), (2, False)])
def test_a_value_received_from_a_channel_is_added_as_it_was_sent(received: int, holds: bool) -> None:
    """If the sum faults, the reader does not read again, and the writer waits forever."""
    adds = Assign(Target("w", INT), Bin("+", Ref("v", INT), Lit(MOST - 1, INT), INT))
    reader = Seq((read("c"), Catch(Seq((adds, read("c", "w"))), "Fault", Skip())))
    body = Par((reader, Seq((write("c", received), write("c", 0)))))
    assert decide(made(body), "deadlock free").holds is holds


def test_a_loop_that_doubles_faults_in_the_end() -> None:
    doubles = Seq((Assign(Target("v", INT), Bin("+", Ref("v", INT), Ref("v", INT), INT)), Wait(MS)))
    body = Catch(Mu(doubles), "Fault", Write("o", Ref("v", INT)))
    assert page_run(made(body, -1), 100 * MS).trace == [(63 * MS, "o", LEAST)]
    assert decide(made(body, 1), "terminates").holds is True


def test_what_waits_for_a_sum_of_times_faults_where_that_overflows() -> None:
    """`v` is 9223372036 s; more than 854 ms and 775807 ns later there is no time."""
    first = 9223372036 * 10**9

    def late(more: int) -> Expr:
        return Bin("+", Ref("v", TIME), Lit(more, TIME), TIME)

    def run(body: Comp) -> list[tuple[int, str, Value]]:
        return page_run(made(Catch(body, "Fault", write("o", 9)), first, TIME), 40 * MS).trace

    def turn(time: Expr) -> Comp:
        return Alt((Guarded(After(time), Skip()), Guarded(Skip(), write("o", 1))))

    assert run(Wait(late(855 * MS))) == [(0, "o", 9)]
    assert run(Wait(late(855 * MS), until=True)) == [(0, "o", 9)]
    assert run(Wait(late(854 * MS))) == []
    assert run(turn(late(855 * MS))) == [(0, "o", 9)]
    assert run(turn(late(854 * MS))) == [(0, "o", 1)]


def test_an_instant_is_waited_for_wherever_it_was_computed() -> None:
    body = Seq((Wait(3 * MS), Wait(Bin("+", Ref("v", TIME), Lit(2 * MS, TIME), TIME), until=True), write("o", 1)))
    assert page_run(made(body, 5 * MS, TIME), 40 * MS).trace == [(7 * MS, "o", 1)]
    beside = Par((Seq((body, Mu(Wait(MS), Bin("<", Ref("v", TIME), Lit(0, TIME), BOOL)))), Skip()))
    assert decide(made(beside, 5 * MS, TIME), "deadlock free").states > 5


def test_a_guard_that_writes_a_sum_faults_before_it_is_offered() -> None:
    guard = Guarded(Write("c", Bin("+", Ref("v", INT), Lit(1, INT), INT)), Skip())
    body = Par((Catch(Alt((guard, Guarded(After(MS), Skip()))), "Fault", write("o", 4)), Read("c", Target("w", INT))))
    assert page_run(made(body, MOST), 5 * MS).trace == [(0, "o", 4)]


def test_a_law_whose_next_state_faults_sets_neither_outputs_nor_states() -> None:
    grown = Bin("+", Ref("s", INT), Ref("x", INT), INT)
    law = Law("a", (("x", INT, "v"),), (("y", INT, "w", Ref("s", INT)),), (("s", INT, 7, grown),), None, 0)
    twice = Catch(Seq((Run("a"), Run("a"))), "Fault", Write("o", Ref("w", INT)))
    assert page_run(made(twice, MOST - 7, laws=(law,)), MS).trace == [(0, "o", 7)]
    assert page_run(made(twice, MOST - 6, laws=(law,)), MS).trace == [(0, "o", 0)]
