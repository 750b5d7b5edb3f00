"""A specification is taken literally: what is not followed in it does not allow every value, and what priorities and
times rule out is not allowed.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from tests.support.verifying import answer_to


@dataclass(frozen=True)
class Pair:
    """The assertion about a process and its specification, with the ports of both, and the declarations of each."""

    process: str
    specification: str
    outcome: str
    ports: str = "out o : int"
    own: str = ""
    declared: str = ""
    before: str = ""
    only_specified: str = ""
    model: str = ""

    @property
    def text(self) -> str:
        """The program."""
        return (
            f"{self.before}\n"
            f"process P {{\n  {self.ports}\n  communication {{ {self.own} }}\n  composition {{ {self.process} }}\n}}\n"
            f"process Q {{\n  {self.ports} {self.only_specified}\n  communication {{ {self.declared} }}\n"
            f"  composition {{ {self.specification} }}\n}}\nassert P refines Q{self.model}\n"
        )


COPIES = "in i : int out o : int"
REALS = "in i : double out o : double"
X, XY = "var x : int = 0", "var x : int = 0 var y : int = 0"
REAL = "var x : double = 0"
POINT = "struct Point { a : int b : int }"
POINTS = "in i : Point out o : Point"
HERE = "var p : Point = Point(a = 1, b = 2)"
LAW = "submodel Next { in u : int out y : int y = u + 1 }"
RUNS_LAW = f"{XY} law : Next x -> law.u law.y -> y"
SAMPLED = "in i : int @ 1 ms out o : int"
TWO = "out o, p : int"

VALUES = {
    "a variable": Pair("mu (wait 1 ms ; o ! 7)", "mu (wait 1 ms ; o ! n)", "refuted", declared="var n : int = 0"),
    "its value": Pair("mu (wait 1 ms ; o ! 0)", "mu (wait 1 ms ; o ! n)", "proved", declared="var n : int = 0"),
    "a parameter": Pair(
        "o ! 7",
        "five",
        "refuted",
        declared="five : Writes(5) five.o -> o",
        before="process Writes(k : int) { out o : int composition { o ! k } }",
    ),
    "a constant for what was read": Pair("mu (i ? x ; o ! 7)", "mu (i ? x ; o ! x)", "refuted", COPIES, X, X),
    "what was read": Pair("mu (i ? x ; o ! x)", "mu (i ? x ; o ! x)", "proved", COPIES, X, X),
    "what was read before": Pair("mu (i ? y ; o ! x ; x := y)", "mu (i ? x ; o ! x)", "refuted", COPIES, XY, X),
    "more than was read": Pair("mu (i ? x ; o ! x + 1)", "mu (i ? x ; o ! x)", "refuted", COPIES, X, X),
    "a number that was compared": Pair(
        "mu (i ? x ; if x == 7 then o ! 7 else o ! x)",
        "mu (i ? x ; if x < 7 then o ! x else o ! x)",
        "proved",
        COPIES,
        X,
        X,
    ),
    "what is computed from what was read": Pair(
        "mu (i ? x ; o ! x)", "mu (i ? x ; o ! x + 1)", "unknown", COPIES, X, X
    ),
    "one of two that were read": Pair(
        "mu (i ? x ; i ? y ; o ! y)",
        "mu (i ? x ; i ? y ; (skip -> o ! x [] skip -> o ! y))",
        "unknown",
        COPIES,
        XY,
        XY,
    ),
    "through a channel": Pair(
        "mu (i ? x ; o ! x)",
        "(mu (i ? x ; c ! x)) || (mu (c ? y ; o ! y))",
        "proved",
        COPIES,
        X,
        f"{XY} channel c : int sync",
    ),
    "another through a channel": Pair(
        "mu (i ? x ; o ! 0)",
        "(mu (i ? x ; c ! x)) || (mu (c ? y ; o ! y))",
        "refuted",
        COPIES,
        X,
        f"{XY} channel c : int sync",
    ),
    "a counter": Pair(
        "mu (o ! 0 ; n := n + 1) until n > 5",
        "mu (o ! n ; n := n + 1) until n > 5",
        "refuted",
        own="var n : int = 0",
        declared="var n : int = 0",
    ),
    "the same counter": Pair(
        "mu (o ! n ; n := n + 1) until n > 5",
        "mu (o ! n ; n := n + 1) until n > 5",
        "proved",
        own="var n : int = 0",
        declared="var n : int = 0",
    ),
    "a counter without end": Pair(
        "mu (wait 1 ms ; o ! 7)", "mu (wait 1 ms ; o ! n ; n := n + 1)", "unknown", declared="var n : int = 0"
    ),
    "a real number": Pair("mu (i ? x ; o ! 7)", "mu (i ? x ; o ! x)", "refuted", REALS, REAL, REAL),
    "the same real number": Pair("mu (i ? x ; o ! x)", "mu (i ? x ; o ! x)", "proved", REALS, REAL, REAL),
    "twice a real number": Pair("mu (i ? x ; o ! 3 * x)", "mu (i ? x ; o ! 2 * x)", "unknown", REALS, REAL, REAL),
    "a structure": Pair(
        "mu (wait 1 ms ; o ! Point(a = 1, b = 3))",
        "mu (wait 1 ms ; o ! p)",
        "refuted",
        "out o : Point",
        declared=HERE,
        before=POINT,
    ),
    "its fields": Pair(
        "mu (wait 1 ms ; o ! Point(a = 1, b = 2))",
        "mu (wait 1 ms ; o ! p)",
        "proved",
        "out o : Point",
        declared=HERE,
        before=POINT,
    ),
    "a structure that was read": Pair(
        "mu (i ? p ; o ! p)", "mu (i ? p ; o ! p)", "proved", POINTS, HERE, HERE, before=POINT
    ),
    "a constant for a structure": Pair(
        "mu (i ? p ; o ! Point(a = 1, b = 2))", "mu (i ? p ; o ! p)", "refuted", POINTS, HERE, HERE, before=POINT
    ),
    "a field of a structure": Pair(
        "mu (i ? p ; o ! p.b)",
        "mu (i ? p ; o ! p.a)",
        "unknown",
        "in i : Point out o : int",
        HERE,
        HERE,
        before=POINT,
    ),
    "an array": Pair(
        "mu (wait 1 ms ; o ! [1, 3])",
        "mu (wait 1 ms ; o ! a)",
        "refuted",
        "out o : int[2]",
        declared="var a : int[2] = [1, 2]",
    ),
    "an element of an array": Pair(
        "mu (wait 1 ms ; o ! 1)", "mu (wait 1 ms ; o ! a[1])", "refuted", declared="var a : int[2] = [1, 2]"
    ),
    "a law": Pair("mu (i ? x ; o ! x)", "mu (i ? x ; law ; o ! y)", "unknown", COPIES, X, RUNS_LAW, LAW),
    "a law at an output": Pair(
        "mu (i ? x ; o ! x)", "mu law", "unknown", COPIES, X, "law : Next i -> law.u law.y -> o", LAW
    ),
    "a fault": Pair("i ? x ; o ! 1", "i ? x ; y := 10 / x ; o ! 1", "unknown", COPIES, X, XY),
    "a certain fault": Pair("o ! 1", "o ! 10 / x", "refuted", declared=X),
    "a choice of its own": Pair(
        "o ! 5 ; o ! 6", "mu (j ? x ; o ! x) until x == 6", "unknown", declared=X, only_specified="in j : int"
    ),
    "any value": Pair(
        "mu (o ! 5 ; wait 1 ms ; o ! 6)", "mu (j ? x ; o ! x)", "proved", declared=X, only_specified="in j : int"
    ),
    "any value, twice the same": Pair(
        "mu (o ! 5 ; wait 1 ms ; o ! 6)",
        "mu (j ? x ; o ! x ; o ! x)",
        "unknown",
        declared=X,
        only_specified="in j : int",
    ),
}

ORDERS = {
    "priority": Pair("o ! 2", "skip -> o ! 1 []> skip -> o ! 2", "refuted"),
    "the first by priority": Pair("o ! 1", "skip -> o ! 1 []> skip -> o ! 2", "proved"),
    "an output by priority": Pair("p ! 2", "o ! 1 -> skip []> p ! 2 -> skip", "refuted", TWO),
    "priority over what comes from outside": Pair(
        "i ? x ; o ! 2", "skip -> (i ? x ; o ! 1) []> i ? x -> o ! 2", "refuted", COPIES, X, X
    ),
    "either": Pair("o ! 2", "skip -> o ! 1 [] skip -> o ! 2", "proved"),
    "priority of processes": Pair("p ! 2 ; o ! 1", "o ! 1 ||> p ! 2", "unknown", TWO),
    "processes in any order": Pair("p ! 2 ; o ! 1", "o ! 1 || p ! 2", "proved", TWO),
    "the shorter delay": Pair("wait 2 ms ; o ! 2", "after 1 ms -> o ! 1 [] after 2 ms -> o ! 2", "unknown"),
    "a delay next to what is ready": Pair("wait 2 ms ; o ! 1", "after 1 ms -> o ! 1 [] skip -> o ! 2", "refuted"),
    "a delay in parallel with another process": Pair("o ! 1 ; p ! 2", "(wait 1 ms ; o ! 1) || p ! 2", "unknown", TWO),
    "an interrupt in time": Pair("o ! 1 ; o ! 3", "(o ! 1 ; o ! 2) interrupt after 1 ms -> o ! 3", "unknown"),
    "samples of two inputs": Pair(
        "mu (i ? x ; i ? x ; j ? x ; o ! 0)",
        "mu (i ? x -> skip [] j ? x -> o ! 0)",
        "unknown",
        "in i, j : int @ 1 ms out o : int",
        X,
        X,
    ),
}

SAMPLES = {
    "an end after the first sample": Pair("i ? x ; o ! 0", "mu (i ? x ; o ! 0)", "refuted", SAMPLED, X, X),
    "a standstill after the first sample": Pair(
        "i ? x ; o ! 0 ; stop", "mu (i ? x ; o ! 0)", "refuted", SAMPLED, X, X, model=" in failures"
    ),
    "every sample": Pair("mu (i ? x ; o ! 0)", "mu (i ? x ; o ! 0)", "proved", SAMPLED, X, X),
    "every sample is taken": Pair(
        "mu (i ? x ; o ! 0)", "mu (i ? x ; o ! 0)", "proved", SAMPLED, X, X, model=" in failures"
    ),
}

PAIRS = VALUES | ORDERS | SAMPLES


@pytest.mark.parametrize("name", PAIRS)
def test_a_question_gets_the_expected_answer(name: str) -> None:
    answer = answer_to(PAIRS[name].text)
    assert (answer.outcome, answer.replayed) == (PAIRS[name].outcome, PAIRS[name].outcome == "refuted"), answer.reason


@pytest.mark.parametrize(
    ("name", "says"),
    [
        (
            "what is computed from what was read",
            "the value of `x + 1` that `Q` writes to `o` is not followed (case.csp:10)",
        ),
        (
            "a law at an output",
            "the value of the control law `law` that `Q` writes to `o` is not followed (case.csp:9)",
        ),
        ("twice a real number", "the value of `2.0 * x` that `Q` writes to `o` is not followed (case.csp:10)"),
        ("priority of processes", "the priorities of `||>` in `Q` are left out (case.csp:10)"),
        ("the shorter delay", "which guard in `Q` is ready first in time is left out (case.csp:10)"),
    ],
)
def test_what_is_not_followed_is_named_with_its_place(name: str, says: str) -> None:
    assert answer_to(PAIRS[name].text).reason.endswith(says)
