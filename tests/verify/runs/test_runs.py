"""Replays know all runs of a program and no others, as real runs and all schedules of small programs show."""

from __future__ import annotations

from collections import Counter
from random import Random

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier
from tests.properties.drawing import draw_programs
from tests.verify.runs.real_runs import followed
from tests.verify.runs.schedules import TooManyError, endings, small_program


def read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def test_a_program_can_be_guided_to_repeat_a_run() -> None:
    """Random programs in their environments, with samples, time-outs, priorities, interrupts and exceptions."""
    seen = Counter[bool]()

    def look(text: str) -> None:
        network = pipeline.build(SourceFile(name="random.csp", text=text), read).network
        assert network is not None
        entries, run = followed(network, until=60_000_000, most=40)
        assert run.succeeded, (run.divergence, text)
        seen[len(entries) == 40] += 1

    for start in range(100, 104):
        draw_programs(look, 6, start, shrink=False)
    assert seen[True] > 10


def test_what_some_schedule_reaches_is_refuted() -> None:
    """The answer for small closed programs, and the result of an interpreter that tries all their schedules in exact
    times.
    """
    seen = Counter[tuple[str, bool]]()
    for number in (*range(30), 412, 860):
        text = small_program(Random(number))
        obligations = proof_obligations(SourceFile(name="case.csp", text=text), read)
        network = obligations.network("All")
        assert network is not None
        answer = Verifier(obligations, read).answer(obligations.questions[0], Limits(20.0))
        try:
            reached = "deadlock" in endings(network, 1000)
        except TooManyError:
            continue
        assert reached or answer.outcome != "refuted", text
        assert not reached or answer.outcome == "refuted", (answer.reason, text)
        seen[answer.outcome, reached] += 1
    assert seen["refuted", True] > 15
    assert sum(count for (_, reached), count in seen.items() if not reached) > 3
