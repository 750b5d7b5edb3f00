"""Where W0707 reports that samples are missed, a run misses them.

``python -m tests.network.checks.samples.test_missed NUMBER`` tries more programs.
"""

from __future__ import annotations

import random
import re
import sys

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.checks.samples import reads
from cspdiag.network.checks.samples.gaps import NOTHING, Elapsed, Gap, then
from cspdiag.network.diagnostics.samples.rates import SamplesMissed
from cspdiag.runtime.kernel.exceptions import Timeout
from cspdiag.simulate.run import execute

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
    """Whether samples are reported as certainly missed, and whether they are missed; None if the program is refused."""
    chance = random.Random(seed)
    a, b, c = chance.choice(((1, 1, 2), (1, 2, 3), (2, 3, 1), (1, 10, 1), (2, 2, 4), (1, 4, 2)))
    turn = f"{part(chance, 3)} ; {part(chance, 2)}"
    text = PROGRAM.format(a=a, b=b, c=c, first=part(chance, 1), turn=turn)
    built = pipeline.build(SourceFile(name="missed.csp", text=text), read_source)
    if built.network is None:
        return None
    found = [item for item in built.checked.report.diagnostics if isinstance(item, SamplesMissed)]
    is_reported = any(item.is_certain and item.waits > item.reads * item.period for item in found)
    files = pipeline.generate(built.network, read_source, level=1)
    run = execute.simulate(built.network, files, until=1_000_000_000)
    return is_reported, isinstance(run.outcome.error, Timeout)


def hunt(seeds: range) -> tuple[int, int, list[int]]:
    """How many programs were reported to miss samples, how many did in all, and the seeds of the false reports."""
    answers = {seed: answer for seed in seeds if (answer := missed(seed)) is not None}
    wrong = [seed for seed, (is_reported, is_missed) in answers.items() if is_reported and not is_missed]
    return (
        sum(missed_sample_warnings for missed_sample_warnings, _ in answers.values()),
        sum(missed_runs for _, missed_runs in answers.values()),
        wrong,
    )


def test_samples_reported_as_missed_are_missed() -> None:
    missed_sample_warnings, missed_runs, wrong = hunt(range(60))
    assert wrong == []
    assert missed_sample_warnings > 0.8 * missed_runs > 20


FRAME = """exception Hot
process Main {{
  in  e : int
  in  x : double @ 10 ms
  out q : int
  communication {{
    var n : int    = 0
    var v : double = 0
    var w : double = 0
  }}
  composition {{ {composition} }}
}}
"""

IN_AN_ALTERNATIVE = "mu (e ? n -> q ! n []> x ? v -> {part}) until n > 1000"

IN_TIME = [
    "((mu (x ? v)) interrupt after 400 ms -> q ! 1)",
    "(wait 30 ms interrupt after 4 ms -> skip)",
    "(after 5 ms -> skip [] after 25 ms -> skip)",
    "(if false then wait 20 ms)",
    "(while false do wait 20 ms)",
    "(skip -> skip []> skip -> wait 20 ms)",
    "(skip -> skip []> e ? n -> wait 20 ms)",
    "(when false & e ? n -> skip [] after 2 ms -> skip)",
    "(wait 4 ms ; wait 5 ms)",
    "((x ? v ; raise Hot) catch Hot -> wait 4 ms)",
]

TOO_LATE = [
    ("wait 12 ms", "an iteration of the loop can wait 12 ms and takes one sample"),
    ("(wait 4 ms ; wait 7 ms)", "an iteration of the loop can wait 11 ms"),
    ("(seq i < 3 : wait 5 ms)", "an iteration of the loop can wait 15 ms"),
    ("(after 15 ms -> skip [] e ? n -> skip)", "an iteration of the loop can wait 15 ms"),
    ("(if n > 3 then wait 20 ms)", "between two reads of `x`, which comes every 10 ms, this can wait 20 ms"),
    ("(wait 30 ms interrupt after 24 ms -> skip)", "this waits 24 ms"),
    ("((mu (x ? v)) interrupt after 400 ms -> wait 20 ms)", "this waits 20 ms"),
    ("e ? n", "this waits for the event `e`"),
]

LOOPS = [
    ("mu ((x ? v ; raise Hot) catch Hot -> wait 30 ms)", "this waits 30 ms: samples are missed"),
    ("mu (x ? v ; (stop interrupt e ? n -> skip))", "this waits for the event `e`"),
    ("mu (x ? v || wait 30 ms)", "each iteration of the loop waits 30 ms"),
    ("mu (x ? v ; (seq i < 3 : wait 5 ms))", "each iteration of the loop waits 15 ms and takes one sample"),
    ("mu (x ? v ; (if v > 3 then wait 12 ms else (wait 8 ms ; wait 4 ms)))", "each iteration of the loop waits 12 ms"),
    ("mu (x ? v ; (if v > 3 then wait 12 ms else wait 11 ms))", "an iteration of the loop can wait 12 ms"),
    ("mu (x ? v ; (((if v > 3 then wait 4 ms) ; wait 12 ms) || wait 17 ms))", "each iteration of the loop waits 17 ms"),
    ("mu (x ? v ; wait 12 ms ; (if v > 3 then x ? v))", "an iteration of the loop can wait 12 ms and takes one sample"),
    ("mu (x ? v ; (seq i < 2 : (if v > 3 then wait 6 ms)))", "an iteration of the loop can wait 12 ms"),
    ("mu (x ? v ; (while v > 3 do (v := v - 1 ; wait 12 ms)))", "an iteration of the loop can wait 12 ms"),
    ("mu (x ? v ; (wait 12 ms interrupt e ? n -> skip))", "an iteration of the loop can wait 12 ms"),
    ("mu (x ? v ; (wait 30 ms interrupt after 15 ms -> skip))", "each iteration of the loop waits 15 ms"),
    ("mu (x ? v ; (e ? n interrupt after 15 ms -> skip))", "an iteration of the loop can wait 15 ms"),
    (
        "mu ((x ? v interrupt e ? n -> skip) ; wait 6 ms)",
        "two iterations of the loop can together wait 12 ms and take one",
    ),
    (
        "mu ((if n > 3 then x ? v) ; n := n + 1 ; wait 13 ms)",
        "this waits 26 ms where an iteration of the loop reads none",
    ),
    ("mu (e ? n -> wait 12 ms []> x ? v -> skip)", "waits 12 ms after the event `e`: if that comes late in a period"),
    ("mu (e ? n -> wait 8 ms []> x ? v -> skip)", None),
    ("x ? v ; wait 15 ms ; x ? v ; wait 15 ms ; mu x ? v", "this waits 30 ms and takes 2 samples of `x`"),
    ("x ? v ; wait 15 ms ; x ? v ; wait 3 ms ; mu x ? v", None),
    ("mu ((x ? v || wait 12 ms) ; x ? v)", None),
    ("mu ((x ? v ; x ? v) || (x ? w ; wait 2 ms))", "each iteration of the loop waits 20 ms for `x`"),
    ("mu ((wait 2 ms interrupt after 20 ms -> (e ? n ; x ? v)) ; x ? v)", None),
    ("mu ((skip -> skip [] x ? v -> wait 30 ms) ; x ? v)", None),
    ("mu (e ? n -> e ? n []> x ? v -> skip)", "this waits for the event `e`"),
    ("mu (e -> (e ? n ; e ? n) []> x ? v -> skip)", "this waits for the event `e`"),
    ("mu (e -> e ? n []> x ? v -> skip)", None),
    ("mu (e -> (if v > 1 then e ? n else e ? n) []> x ? v -> skip)", None),
    ("mu (when v < 50 & x ? v -> skip [] after 30 ms -> v := 0)", "this waits 30 ms"),
    ("mu (when v < 50 & x ? v -> skip [] when not (v < 50) & after 30 ms -> v := 0)", "this waits 30 ms"),
    ("mu (when v < 50 & x ? v -> skip [] when v < 50 & after 30 ms -> v := 0)", None),
    ("mu (when n < 50 & x ? v -> skip [] after 30 ms -> v := 0)", None),
    ("mu (when v < 50 & x ? v -> skip [] after 30 ms -> skip)", None),
    ("mu (when v < 50 & x ? v -> skip [] after 8 ms -> v := 0)", None),
    ("mu (((x ? v ; wait 20 ms ; x ? v) interrupt after 5 ms -> skip) ; x ? v)", None),
    ("mu (((x ? v ; wait 20 ms ; x ? v) interrupt after 50 ms -> skip) ; x ? v)", "this waits 20 ms"),
    ("(mu (x ? v ; wait 11 ms)) interrupt after 60 ms -> skip", None),
    ("(mu (x ? v ; wait 11 ms)) interrupt after 1 s -> skip", "each iteration of the loop waits 11 ms"),
    ("mu (x ? v ; (wait 20 ms interrupt x ? w -> skip))", None),
    ("mu (prialt k < 2 : after (2 - k) * 20 ms -> x ? v)", "between two reads of `x`, which comes every 10 ms"),
    ("mu (prialt k < 2 : after (2 - k) * 4 ms -> x ? v)", None),
    ("mu (mu x ? v interrupt x ? w -> wait 15 ms)", "this can wait 30 ms"),
    ("mu (x ? v ; (if v == 100 then wait 25 ms))", "this can wait 25 ms: where it does, samples are missed"),
    ("mu (x ? v ; (if v == 100 then wait 25 ms else wait 30 ms))", "this can wait 30 ms"),
    ("mu (x ? v ; (if v == 100 then wait 25 ms else wait 25 ms))", "this waits 25 ms: samples are missed"),
    ("mu (x ? v ; (if v == 100 then wait 25 ms) ; wait 25 ms)", "this can wait 50 ms"),
    (
        "mu ((if v == 100 then skip else x ? v) ; wait 25 ms ; x ? v ; wait 1 ms)",
        "this waits 25 ms: samples are missed",
    ),
    ("mu (x ? v ; (if v == 100 then e ? n))", "this can wait for the event `e`: if that takes longer"),
    ("mu (x ? v ; (if v == 100 then e ? n else e ? n))", "this waits for the event `e`"),
    ("stop ; mu (x ? v ; wait 30 ms)", None),
]


def missed_sample_warnings(composition: str) -> list[str]:
    source = SourceFile(name="loop.csp", text=FRAME.format(composition=composition))
    checked = pipeline.build(source, read_source).checked
    assert not checked.report.has_errors
    return [item.message for item in checked.report.diagnostics if isinstance(item, SamplesMissed)]


@pytest.mark.parametrize("part", IN_TIME)
def test_what_ends_within_a_period_or_cannot_be_reached_is_no_delay(part: str) -> None:
    assert missed_sample_warnings(IN_AN_ALTERNATIVE.format(part=part)) == []


@pytest.mark.parametrize(("part", "message"), TOO_LATE)
def test_a_step_that_takes_a_period_on_some_path_is_a_delay(part: str, message: str) -> None:
    (found,) = missed_sample_warnings(IN_AN_ALTERNATIVE.format(part=part))
    assert message in found


@pytest.mark.parametrize(("composition", "message"), LOOPS)
def test_delays_are_added_up_along_a_path(composition: str, message: str | None) -> None:
    found = missed_sample_warnings(composition)
    assert len(found) == (message is not None)
    assert all(str(message) in each for each in found)


LAW = """submodel Law {
  in  u : double
  out y : double
  y = u
}
"""

READERS = """process Main {{
  in  z : double @ 20 ms
  in  u[2] : double @ 20 ms
  in  x : double @ 10 ms
  in  e : int
  out q : double @ 10 ms
  out p : double @ 20 ms
  communication {{
{laws}    var v : double = 0
    var w : double = 0
    var n : int    = 0
  }}
  composition {{ {composition} }}
}}
"""


@pytest.mark.parametrize(
    ("composition", "message"),
    [
        ("x ? v ; x ? v ; z ? w ; mu x ? v", "waits 20 ms for `z`"),
        ("mu (x ? v ; x ? v ; z ? w)", "waits 20 ms for `z`"),
        ("x ? v ; z ? w ; mu x ? v", None),
        ("((mu x ? v) interrupt after 35 ms -> wait 15 ms) ; mu x ? v", "waits 20 ms"),
        ("((mu x ? v) interrupt after 35 ms -> wait 14 ms) ; mu x ? v", None),
        ("x ? v ; (wait 40 ms interrupt after 30 ms -> skip) ; (skip interrupt after 1 ms -> skip)", None),
        ("(wait 5 ms interrupt after 50 ms -> skip) ; x ? v ; x ? v ; e ? n ; z ? w ; stop", None),
    ],
)
def test_the_beginning_is_stepped_through(composition: str, message: str | None) -> None:
    found = warnings_of(composition)
    assert len(found) == (message is not None)
    assert all(str(message) in each.message for each in found)


@pytest.mark.parametrize(
    ("turn", "remedy"),
    [
        ("z ? w ; x ? v", "mu (z ? w -> ... []> x ? v -> ...)"),
        ("x ? v ; z ? w", "mu (z ? w -> ... []> x ? v -> ...)"),
        ("b ; a", "mu (z -> b []> x -> a)"),
        ("b ; x ? v", "mu (z -> b []> x ? v -> ...)"),
        ("a || (skip ; z ? w)", "mu (z ? w -> ... []> x -> a)"),
        ("(x -> a) ; b", "mu (z -> b []> x -> a)"),
        ("e ? n ; x ? v", "e ? n -> ... []> x ? v -> ..."),
        ("e ? n ; a", "e ? n -> ... []> x -> a"),
        ("a ; (stop interrupt e ? n -> skip)", "e ? n -> ... []> x -> a"),
        ("u[1] ? w ; x ? v", "mu (u[1] ? w -> ... []> x ? v -> ...)"),
    ],
)
def test_a_remedy_can_be_put_in_place_of_the_loop(turn: str, remedy: str) -> None:
    (found,) = warnings_of(f"mu ({turn})")
    assert found.help is not None
    assert f"`{remedy}`" in found.help
    whole = remedy if remedy.startswith("mu") else f"mu ({remedy})"
    assert warnings_of(whole.replace("...", "skip")) == []


def test_what_is_replicated_is_not_written_as_a_remedy() -> None:
    (found,) = warnings_of("mu ((seq i < 2 : u[i] ? w) ; x ? v)")
    assert found.help is not None
    assert "`" not in found.help


def warnings_of(composition: str) -> list[SamplesMissed]:
    wires = {"a": ("x", "q"), "b": ("z", "p")}
    laws = "".join(
        f"{law} : Law  {source} -> {law}.u  {law}.y -> {sink}\n"
        for law, (source, sink) in wires.items()
        if re.search(rf"\b{law}\b", composition)
    )
    source = SourceFile(name="loop.csp", text=LAW + READERS.format(composition=composition, laws=laws))
    report = pipeline.build(source, read_source).checked.report
    assert not report.has_errors
    return [item for item in report.diagnostics if isinstance(item, SamplesMissed)]


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


def test_the_work_for_a_parallel_grows_with_its_branches(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = [0, 0]
    combined = reads.both
    for position, branches in enumerate((50, 100)):

        def counted(one: Gap | None, other: Gap | None, position: int = position) -> Gap | None:
            steps[position] += 1
            return combined(one, other)

        monkeypatch.setattr(reads, "both", counted)
        reads.in_parallel([reads.part(Gap())] * branches)
    assert steps[1] < 2.2 * steps[0]
