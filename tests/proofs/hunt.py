"""``python -m tests.proofs.hunt --random 20000``: every proof method compared with the plain interpretation, on random
systems.

Prints each wrong answer with the seed of its system, and how often each method answered; the exit code is 1 if an
answer was wrong.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.properties import livelock, termination
from cspdiag.proofs.reduce import minimization
from cspdiag.proofs.search import breadth_first, stubborn
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Method, Proved, Refuted, Unknown, Verdict
from tests.proofs.systems import naive
from tests.proofs.systems.random_networks import FORMS, plain_knot, random_network
from tests.proofs.systems.random_systems import random_system

Engine: TypeAlias = Callable[[System, Limits], Verdict]
Condition: TypeAlias = Callable[[System, naive.State], bool]


@dataclass(frozen=True)
class Question:
    """A property, the states that refute it, and the engines that answer. ``exact`` engines may not answer that they do
    not know.
    """

    name: str
    refuted_by: Condition
    exact: dict[str, Engine]
    partial: dict[str, Engine]


def engine_of(prove: Callable[[System, Limits, Sequence[Method]], Verdict], *methods: Method) -> Engine:
    """The engine that uses only some methods of the portfolio."""
    return lambda system, limits: prove(system, limits, methods)


QUESTIONS = (
    Question(
        "deadlock",
        naive.deadlocked,
        {
            "breadth-first": breadth_first.deadlock_free,
            "stubborn": stubborn.deadlock_free,
            "minimization": minimization.deadlock_free,
            "portfolio": prove_deadlock_free,
        },
        {"rules": engine_of(prove_deadlock_free, "rules"), "sat": engine_of(prove_deadlock_free, "rules", "sat")},
    ),
    Question(
        "knots",
        lambda system, state: bool(plain_knot(system, state)),
        {"breadth-first": breadth_first.knot_free, "portfolio": prove_knot_free},
        {
            "minimization": minimization.knot_free,
            "stubborn": stubborn.knot_free,
            "rules": engine_of(prove_knot_free, "rules"),
            "sat": engine_of(prove_knot_free, "rules", "sat"),
        },
    ),
    Question("livelock", naive.livelocked, {"livelock": livelock.livelock_free}, {}),
    Question("termination", naive.never_ends, {"termination": termination.terminates}, {}),
)


def wrong(question: Question, system: System, holds: bool, verdict: Verdict, *, exact: bool) -> str | None:
    """What is wrong with an answer, if anything is."""
    match verdict:
        case Proved():
            return None if holds else f"{verdict.method} proved what is refuted"
        case Refuted():
            if holds:
                return f"{verdict.method} refuted what is true"
            try:
                last = naive.replay(system, verdict.trace)
                again = naive.replay(system, verdict.trace + verdict.cycle)
            except AssertionError as impossible:
                return str(impossible)
            if not question.refuted_by(system, last) or again != last:
                return f"the trace of {verdict.method} leads elsewhere"
            return None
        case Unknown():
            return f"{verdict.method} does not know: {verdict.reason}" if exact else None


def system_of(seed: int) -> System:
    """Plain random systems, and networks of each of the forms in turn."""
    form = (None, *FORMS)[seed % (1 + len(FORMS))]
    return random_system(seed) if form is None else random_network(seed, form=form)


def apply_methods(seed: int, answers: Counter[tuple[str, str, str]]) -> list[str]:
    """Apply every method to the system of a seed and count the answers. Returns the wrong answers."""
    found: list[str] = []
    system = system_of(seed)
    states = [state for layer in naive.layers(system) for state in layer]
    for question in QUESTIONS:
        holds = not any(question.refuted_by(system, state) for state in states)
        answers[question.name, "truth", "Proved" if holds else "Refuted"] += 1
        for name, engine in (question.exact | question.partial).items():
            verdict = engine(system, Limits())
            answers[question.name, name, type(verdict).__name__] += 1
            mistake = wrong(question, system, holds, verdict, exact=name in question.exact)
            if mistake is not None:
                found.append(f"seed {seed}, {question.name}, {name}: {mistake}")
    return found


def main() -> int:
    """Hunt as the command line says; Ctrl-C ends the hunt and prints what was found so far."""
    parser = argparse.ArgumentParser(prog="python -m tests.proofs.hunt")
    parser.add_argument("--random", type=int, default=2000, metavar="N", help="how many systems (default: 2000)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed (default: 0)")
    given = parser.parse_args()
    answers: Counter[tuple[str, str, str]] = Counter()
    found: list[str] = []
    done = 0
    with suppress(KeyboardInterrupt):
        for seed in range(given.first, given.first + given.random):
            for mistake in apply_methods(seed, answers):
                print(mistake, flush=True)
                found.append(mistake)
            done += 1
    for (question, name, answer), times in sorted(answers.items()):
        print(f"{question:10} {name:14} {answer:8} {times:7}")
    for question in ("deadlock", "knots"):
        free, proved = answers[question, "truth", "Proved"], answers[question, "sat", "Proved"]
        print(f"{question}: {proved} of {free} systems without are proved without search ({proved / max(1, free):.2%})")
    print(f"{len(found)} wrong answers in {done} random systems")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
