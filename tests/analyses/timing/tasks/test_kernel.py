"""The kernel's time at instants: how often it is counted, and where there is no bound."""

from __future__ import annotations

import pytest

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.analyses.timing.tasks.kernel import kernel_tasks
from cspdiag.analyses.timing.threads.threads import Threads
from cspdiag.network.ir.network import Network
from tests.analyses.timing.programs import network_of
from tests.codegen.packages import network as jiwy

PROGRAM = """
submodel Law wcet 100 us {{ in x : double  out y : double  y = x }}
process Main {{
  in  a : double @ {a}
  in  b : double @ {b}
  out p : double @ {a}
  out q : double @ {q}
  {more}
  communication {{ one : Law  two : Law  a -> one.x  b -> two.x  one.y -> p  two.y -> q  {var} }}
  composition {{ mu one || mu two {branch} }}
}}
"""


def program(
    b: str = "3 ms", *, a: str = "2 ms", q: str = "", more: str = "", var: str = "", branch: str = ""
) -> Network:
    return network_of(PROGRAM.format(a=a, b=b, q=q or b, more=more, var=var, branch=branch))


def periods(network: Network) -> list[int]:
    refusals: list[Refusal] = []
    found = kernel_tasks(network, 10_000, Threads(network, {}).channel_ends.constant, refusals)
    assert not refusals
    return [task.period // 1_000_000 for task in found.all]


def test_instants_that_are_ticks_of_shorter_periods_count_once() -> None:
    assert periods(program("6 ms")) == [2]
    assert periods(program("3 ms")) == [2, 3]


def test_ticks_between_those_of_a_shorter_period_count_by_themselves() -> None:
    assert periods(program("4 ms", q="4 ms offset 1 ms")) == [2, 4]


def test_events_are_polled_at_the_common_divisor_of_the_periods() -> None:
    assert periods(jiwy("jiwy"))[0] == 1


def test_what_was_not_measured_is_no_task() -> None:
    assert timing_report(program(), {}).kernel == 0
    assert timing_report(program(), {}).utilization == timing_report(program(), {}, kernel=0).utilization


def test_delays_end_as_often_as_they_last() -> None:
    assert periods(program("6 ms", branch="|| mu wait 5 ms")) == [2, 5]
    assert set(periods(jiwy("jiwy"))) == {1, 3_000, 10_000}


def test_delays_that_may_be_short_have_no_bound() -> None:
    late = program(var="var t : time = 1 ms", branch="|| mu (wait t ; t := 2 * t)")
    (refusal,) = timing_report(late, {}, kernel=10_000).refusals
    assert refusal.subject == "Main"
    assert "not constant" in refusal.reason


def test_events_need_an_environment_that_says_how_often_they_come() -> None:
    event = {"more": "in e : bool", "var": "var v : bool", "branch": "|| mu e ? v"}
    (refusal,) = timing_report(program(**event), {}, kernel=10_000).refusals
    assert refusal.subject == "Main.e"


@pytest.mark.parametrize(("kernel", "response"), [(0, 200_000), (10_000, 210_000), (1_000_000, None)])
def test_the_kernel_delays_all_processes(kernel: int, response: int | None) -> None:
    rows = timing_report(program("1 ms", a="1 ms"), {}, kernel=kernel).loops
    assert {row.response for row in rows} == {response}
