"""Runs of fast code write what runs of readable code write: recordings, traces, figures, summaries, reports."""

from __future__ import annotations

import numpy
import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.simulate.record.chrome_trace import chrome_trace_text
from cspdiag.simulate.record.files import csv_parts, plain_trace_text
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from tests.codegen.packages import MODELS, network, read

MS = 1_000_000


def run(program: Network, level: int, environment: str | None, until: int | None, *, traced: bool, probed: bool) -> Run:
    """A run of the code of a level."""
    files = pipeline.generate(program, read, level=level, traced=traced, observed=True, probed=probed)
    return simulate(program, files, environment=environment, until=until, probe_variables=probed)


def both(name: str, *, traced: bool = False, probed: bool = False, until: int = 400 * MS) -> tuple[Run, Run]:
    """A model in its first environment, in readable and in fast code."""
    program = network(name)
    environment = program.environments[0].name if program.environments else None
    plain, fast = (run(program, level, environment, until, traced=traced, probed=probed) for level in (0, 1))
    return plain, fast


def account(result: Run) -> list[str]:
    """The summary without what depends on the machine."""
    return [
        line for line in result.summary().splitlines() if " times real time" not in line and "simulated" not in line
    ]


def drawn(result: Run) -> list[tuple[str, object]]:
    """The lines of the figure, by panel."""
    pytest.importorskip("matplotlib")
    return [
        (str(line.get_label()), numpy.asarray(line.get_xydata()).tolist())
        for axes in result.plot().axes
        for line in axes.get_lines()
    ]


@pytest.mark.parametrize("name", MODELS)
def test_traces_are_equal(name: str) -> None:
    plain, fast = both(name, traced=True)
    assert plain_trace_text(fast) == plain_trace_text(plain)
    assert chrome_trace_text(fast) == chrome_trace_text(plain)


@pytest.mark.parametrize("name", MODELS)
def test_recordings_and_summaries_are_equal(name: str) -> None:
    plain, fast = both(name)
    assert "".join(csv_parts(fast)) == "".join(csv_parts(plain))
    assert account(fast) == account(plain)
    assert fast.releases == plain.releases
    assert fast.activities == plain.activities
    assert (fast.outcome.ended, fast.outcome.time, fast.outcome.missed) == (
        plain.outcome.ended, plain.outcome.time, plain.outcome.missed
    )  # fmt: skip
    for one, other in ((fast.outcome, plain.outcome), (plain.outcome, fast.outcome)):
        assert (one.error is None) or (described(one.error) == described(other.error or one.error))
        assert (one.error is None) == (other.error is None)
    text = plain.outcome.deadlock.text if plain.outcome.deadlock is not None else None
    assert (fast.outcome.deadlock.text if fast.outcome.deadlock is not None else None) == text


@pytest.mark.parametrize("name", ["jiwy", "cascade"])
def test_figures_are_equal(name: str) -> None:
    plain, fast = both(name, probed=True)
    assert plain.variables == fast.variables
    assert drawn(fast) == drawn(plain)


PLANT = """
process Loop {
    in  level : double @ 1 ms
    out valve : double @ 1 ms
    communication { var seen : double = 0 }
    composition { mu (level ? seen ; valve ! seen) }
}
submodel Tank step 1 ms {
    in  valve : double
    out level : double
    state filled : double = 0.002
    let rest = 1 / (filled - 0.0005)
    der filled = valve / (filled - 0.001) - 1
    level = %s
}
environment Site for Loop { tank : Tank  valve -> tank.valve  tank.level -> level }
"""
FAILING = {
    "an equation of the plant": PLANT % "rest * (1 / (filled - 0.0015))",
    "a derivative of the plant": PLANT.replace("- 0.001)", "- filled)") % "filled",
    "a control law": """
        submodel Count(most: int8) {
            in  given : int8
            out taken : int8
            state total : int8 = 0
            taken = total
            next total = total + given * most
        }
        process Adder { communication { count : Count(most = 50)  var one : int8 = 1  var sum : int8
            one -> count.given  count.taken -> sum }
            composition { mu (wait 1 ms ; count) } }
    """,
    "an exception": "exception Lost process Find { composition { wait 3 ms ; raise Lost } }",
}


@pytest.mark.parametrize("what", FAILING)
def test_failures_are_reported_in_the_same_words(what: str) -> None:
    built = pipeline.build(SourceFile(name="site.csp", text=FAILING[what]), read)
    assert built.network is not None, built.checked.report.diagnostics
    environment = "Site" if built.network.environments else None
    plain, fast = (run(built.network, level, environment, 100 * MS, traced=True, probed=False) for level in (0, 1))
    assert plain.outcome.ended == "failed"
    assert plain.outcome.error is not None
    assert fast.outcome.error is not None
    assert described(fast.outcome.error) == described(plain.outcome.error)
    assert "site.csp:" in described(plain.outcome.error)
    assert account(fast) == account(plain)
    assert plain_trace_text(fast) == plain_trace_text(plain)


WAITS_INSIDE = """
process Reader {
    in  given : int
    communication { var seen : int = 0 }
    composition { wait 1 ms ;
        given ? seen }
}
process Outer {
    in  given : int
    communication { reader : Reader  given -> reader.given }
    composition { wait 1 ms ; reader }
}
process Mute {
    out taken : int
    communication { var spoken : bool = true }
    composition { if not spoken then taken ! 1 }
}
process Both {
    communication { outer : Outer  mute : Mute  mute.taken -> outer.given }
    composition { outer || mute }
}
"""


def test_a_deadlock_is_reported_at_the_innermost_line() -> None:
    built = pipeline.build(SourceFile(name="both.csp", text=WAITS_INSIDE), read, top="Both")
    assert built.network is not None, built.checked.report.diagnostics
    for level in (0, 1):
        report = run(built.network, level, None, None, traced=False, probed=False).outcome.deadlock
        assert report is not None
        assert "Both.outer.reader waits to read Both.mute.taken (both.csp:6)" in report.text
