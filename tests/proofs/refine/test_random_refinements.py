"""Random refinements: what is proved and what is refuted agrees with an oracle that follows both processes through
everything.

``python -m tests.proofs.refine.test_random_refinements N`` tries N refinements.
"""

from __future__ import annotations

import sys
from collections import Counter
from random import Random

import pytest

from cspdiag.base import SourceFile
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.refine import refinement
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier
from tests.proofs.refine.oracle import Sight, refines
from tests.proofs.refine.small_processes import HEAD, INPUTS, OUTPUTS, Drawing, Statement, erased, process

MOST = 4_000


def drawn(seed: int) -> tuple[Statement, Statement, tuple[int, ...], str]:
    """A process, a specification that is often much like it, numbers for its inputs, and the port that the
    specification does not have, if any.

    The numbers are those of both texts, and their neighbours.
    """
    random = Random(seed)
    numbers = tuple(random.sample((-1, 0, 1, 2, 3, 7, 100), 3))
    hidden = random.choice((*INPUTS, *OUTPUTS)) if random.random() < 0.3 else ""
    drawing = Drawing(random, numbers)
    narrower = Drawing(random, numbers, tuple(port for port in (*INPUTS, *OUTPUTS) if port != hidden))
    body = drawing.body()
    specification = erased(body, hidden) if random.random() < 0.9 else narrower.body()
    holds = random.random() < 0.6
    if holds and not hidden:
        body = drawing.refined(specification)
    for _ in range(0 if holds else random.randint(1, 2)):
        if random.random() < 0.7:
            specification = narrower.changed(specification)
        else:
            body = drawing.changed(body)
    offered = sorted({near for number in (0, *numbers) for near in (number - 1, number, number + 1)})
    return body, specification, tuple(offered), hidden


def comparison(seed: int) -> str:
    """How the answer compares with the truth; ``refused`` if the program has errors."""
    body, specification, numbers, hidden = drawn(seed)
    failures = seed % 2 == 1
    claim = f"P refines Q{' in failures' if failures else ''}{f' hide {hidden}' if hidden else ''}"
    sampled = seed % 5 == 0
    processes = process("P", body, sampled=sampled), process("Q", specification, hidden, sampled=sampled)
    text = "\n".join((HEAD, *processes, f"assert {claim}\n"))
    source = SourceFile(name="random.csp", text=text)

    def read(path: str) -> SourceFile:
        raise FileNotFoundError(path)

    question = proof_obligations(source, read)
    if question.checked.report.has_errors:
        return "refused"
    answer = Verifier(question, read).answer(question.questions[0], Limits(20.0))
    truth = refines(body, specification, Sight(numbers, failures=failures, hidden=hidden), MOST)
    if answer.outcome == "proved":
        assert truth != "violates", f"{seed}: proved\n{text}"
    if answer.outcome == "refuted":
        assert truth != "refines", f"{seed}: refuted\n{text}"
    return f"{answer.outcome}, {truth}"


@pytest.mark.parametrize(("first", "vectors"), [(0, True), (30, True), (60, False), (90, False)])
def test_answers_are_true(first: int, vectors: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refinement, "has_vectors", lambda: vectors)
    found = Counter(comparison(seed) for seed in range(first, first + 30))
    assert found["proved, refines"] >= 2, found
    assert found["refuted, violates"] >= 2, found


if __name__ == "__main__":
    reported = Counter(comparison(seed) for seed in range(int(sys.argv[1]) if len(sys.argv) > 1 else 1000))
    sys.stdout.write("".join(f"{kind}: {number}\n" for kind, number in reported.most_common()))
