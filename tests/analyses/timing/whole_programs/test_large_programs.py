"""Programs with many loops: the effort grows with their number, and the output says what tables leave out."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import pytest

from cspdiag.analyses.timing.report import chains
from cspdiag.analyses.timing.report.render_json import as_json
from cspdiag.analyses.timing.report.render_text import table
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.network.ir.network import Network
from tests.analyses.timing.programs import US, law, loops_of, network_of


def steps(work: Callable[[], object]) -> int:
    """The number of lines of Python that it executes; each iteration of a loop counts."""
    count = 0

    def trace(frame: Any, event: str, argument: Any) -> Any:
        nonlocal count
        count += event == "line"
        return trace

    previous = sys.gettrace()
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(previous)
    return count


def independent(count: int, order: str) -> Network:
    loops = [(f"l{k}", f"{(10, 20, 50, 100)[k % 4]} ms", "20 us") for k in range(count)]
    return network_of(loops_of(*loops, order=order))


def read_by_hand(count: int) -> Network:
    """Loops of the outermost process, which reads each sample itself."""
    names = [f"l{k}" for k in range(count)]
    ports = "".join(f"in x_{n} : double @ 10 ms\nout y_{n} : double @ 10 ms\n" for n in names)
    diagram = "".join(f"{n} : Law\nvar v_{n} : double = 0\nv_{n} -> {n}.x\n{n}.y -> y_{n}\n" for n in names)
    runs = " || ".join(f"mu (x_{n} ? v_{n} ; {n})" for n in names)
    return network_of(
        f"{law('Law', '20 us')}process Main {{\n{ports}communication {{ {diagram} }}\ncomposition {{ {runs} }} }}"
    )


@pytest.mark.parametrize("form", [lambda n: independent(n, "||"), lambda n: independent(n, "||>"), read_by_hand])
def test_twice_the_loops_take_little_more_than_twice_the_effort(form: Callable[[int], Network]) -> None:
    small, large = form(30), form(60)
    timing_report(small)  # Once beforehand, so that imports do not count.
    assert steps(lambda: timing_report(large)) < 2.5 * steps(lambda: timing_report(small))


def test_many_loops_have_the_bounds_of_one_queue() -> None:
    """All loops of one level wait for each other once."""
    report = timing_report(independent(120, "||"))
    assert {loop.response for loop in report.loops} == {120 * 20 * US}
    assert len(report.chains) == 120


def test_loops_and_chains_that_are_not_shown_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    network = independent(230, "||")
    lines = table(timing_report(network)).splitlines()
    assert "and 30 loops more" in lines
    assert "and 30 chains more" in lines
    monkeypatch.setattr(chains, "LARGEST_NUMBER_OF_ROUTES", 205)
    report = timing_report(network)
    assert "and at least 5 chains more" in table(report).splitlines()
    assert as_json(report)["allChains"] is False
