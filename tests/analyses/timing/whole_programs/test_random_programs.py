"""Random programs: whatever they consist of, the analyses give an answer, and a run never does more at an instant than
the bound.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from cspdiag import pipeline
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.margins.loops import analyse_loops
from cspdiag.analyses.timing.report.gantt import gantt_svg
from cspdiag.analyses.timing.report.render_json import render
from cspdiag.analyses.timing.report.render_text import table
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network, SubmodelClass
from cspdiag.runtime import Submodel
from cspdiag.simulate.run.execute import simulate
from cspdiag.simulate.run.probes import parts_of
from tests.properties.drawing import draw_programs


def no_other_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def drawn(count: int, start: int) -> list[Network]:
    texts: list[str] = []
    draw_programs(texts.append, count, start, shrink=False)
    built = [pipeline.build(SourceFile(name="random.csp", text=text), no_other_file).network for text in texts]
    return [network for network in built if network is not None]


def runs_at_instants(network: Network, until: int) -> Counter[int]:
    """The number of laws that a run computes at each instant."""
    found: Counter[int] = Counter()

    def count(running: Any) -> None:
        def counted(calculate: Callable[..., Any]) -> Callable[..., Any]:
            def calculated(*inputs: Any) -> Any:
                found[running.now] += 1
                return calculate(*inputs)

            return calculated

        for law in parts_of(running.process):
            if isinstance(law, Submodel):
                law.calculate = counted(law.calculate)  # type: ignore[attr-defined]

    simulate(network, pipeline.generate(network, no_other_file), until=until, on_start=count)
    return found


@pytest.mark.parametrize("start", [5, 13])
def test_no_run_does_more_at_an_instant_than_is_bounded(start: int) -> None:
    """Each law takes one unit: the demand of all threads together bounds how many laws run at one instant."""
    answered = 0
    for network in drawn(8, start):
        laws = {
            instance.path: 1
            for instance in network.instances
            if isinstance(network.class_named(instance.class_name), SubmodelClass)
        }
        report = timing_report(network, laws)
        assert table(report)
        assert render(report)
        assert gantt_svg(report).startswith("<svg")
        if report.is_schedulable is not None:
            answered += 1
            bound = sum(task.work for task in report.tasks)
            assert max(runs_at_instants(network, 30_000_000).values(), default=0) <= bound
    assert answered


def test_every_loop_has_margins_or_a_reason() -> None:
    reported = 0
    for network in drawn(10, 3):
        for environment in network.environments[:1]:
            try:
                report = analyse_loops(network, environment)
            except NotLinearError:
                continue
            else:
                reported += len(report.loops) + len(report.refusals)
                assert all(refusal.reason for refusal in report.refusals)
    assert reported
