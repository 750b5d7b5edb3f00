"""Where W0707 says that samples are missed, a run misses them.

``python -m tests.network.test_missed_samples NUMBER`` tries more programs.
"""

from __future__ import annotations

import random
import sys

from cspdiag import pipeline
from cspdiag.diagnostics.span import SourceFile
from cspdiag.network.diagnostics_rates import SamplesMissed
from cspdiag.network.gaps import NOTHING, Elapsed, Gap, then
from cspdiag.runtime.exceptions import Timeout
from cspdiag.simulate import execute
from cspdiag.sources import read_source

PROGRAM = """
process Main {{
  in  a : double @ {a} ms
  in  b : double @ {b} ms
  in  c : double @ {c} ms
  out o : double @ 1 ms
  communication {{
    var x  : double = 0
    var n1 : int    = 0
    var n2 : int    = 0
    var n3 : int    = 0
  }}
  composition {{ {first} ; mu ({turn}) }}
}}

submodel Source {{
  out y : double
  y = time / 1<s>
}}

environment Bench for Main {{
  source[3] : Source
  source[0].y -> a
  source[1].y -> b
  source[2].y -> c
  o -> _
}}
"""


def part(chance: random.Random, depth: int) -> str:
    kind = chance.random() if depth else 0.0
    if kind < 0.55:
        delay = chance.choice((100, 500, 1000, 1500, 2000, 2500, 4000, 7000))
        return chance.choice(("a ? x", "a ? x", "b ? x", "b ? x", "c ? x", "o ! x", "skip", f"wait {delay} us"))
    if kind < 0.9:
        return f"({' ; '.join(part(chance, depth - 1) for _ in range(chance.randint(2, 4)))})"
    body, turns = part(chance, depth - 1), chance.randint(1, 3)
    return f"(n{depth} := 0 ; mu ({body} ; n{depth} := n{depth} + 1) until n{depth} >= {turns})"


def missed(seed: int) -> tuple[bool, bool] | None:
    """Whether samples are certainly missed, and whether they are; None where the program is refused."""
    chance = random.Random(seed)
    a, b, c = chance.choice(((1, 1, 2), (1, 2, 3), (2, 3, 1), (1, 10, 1), (2, 2, 4), (1, 4, 2)))
    turn = f"{part(chance, 3)} ; {part(chance, 2)}"
    text = PROGRAM.format(a=a, b=b, c=c, first=part(chance, 1), turn=turn)
    built = pipeline.build(SourceFile(name="missed.csp", text=text), read_source)
    if built.network is None:
        return None
    found = [item for item in built.checked.report.diagnostics if isinstance(item, SamplesMissed)]
    is_said = any(item.is_certain and item.waits > item.reads * item.period for item in found)
    files = pipeline.generate(built.network, read_source, level=1)
    run = execute.simulate(built.network, files, until=1_000_000_000)
    return is_said, isinstance(run.outcome.error, Timeout)


def hunt(seeds: range) -> tuple[int, int, list[int]]:
    """How many programs were said to miss samples, how many did in all, and the seeds of those of which it was said wrongly."""
    answers = {seed: answer for seed in seeds if (answer := missed(seed)) is not None}
    wrong = [seed for seed, (is_said, is_so) in answers.items() if is_said and not is_so]
    return sum(said for said, _ in answers.values()), sum(so for _, so in answers.values()), wrong


def test_samples_that_are_said_to_be_missed_are() -> None:
    said, so, wrong = hunt(range(60))
    assert wrong == []
    assert said > 0.8 * so > 20


def test_what_has_elapsed_is_what_the_steps_add_up_to() -> None:
    chance = random.Random(5)
    for _ in range(200):
        steps: list[Gap | None] = [
            chance.choice((NOTHING, Gap(chance.randint(1, 9)), Gap(chance.randint(1, 9)), Gap(0, f"e{number}"), None))
            if chance.random() < 0.9 or number < 3
            else NOTHING
            for number in range(8)
        ]
        elapsed = Elapsed()
        moments = []
        for step in steps:
            moments.append(elapsed.position)
            elapsed.add(step)
        for number, moment in enumerate(moments):
            expected: Gap | None = NOTHING
            for step in steps[number:]:
                expected = then(expected, step)
            found = elapsed.since(moment)
            assert (found and found.rank) == (expected and expected.rank)
            assert (found and found.event) == (expected and expected.event)


if __name__ == "__main__":
    print(hunt(range(int(sys.argv[1]))))
