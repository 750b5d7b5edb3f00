"""A server with several client loops: a client waits for its answer, and for the requests that the others made
before.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.processor import longest, on_processor, wcets, with_bench
from tests.analyses.timing.programs import MS, US, by_name, law, report_of


@pytest.fixture(autouse=True)
def processor() -> Iterator[None]:
    with on_processor():
        yield


SERVED = (
    law("Serve", "200 us") + law("Fast", "100 us") + law("Slow", "300 us") +
    """
    process Server {
      in  ask[2]    : double
      out answer[2] : double
      communication {
        serve : Serve
        var question : double = 0
        var result   : double = 0
        question -> serve.x
        serve.y -> result
      }
      composition {
        mu (
          ask[0] ? question -> (serve ; answer[0] ! result)
          <choice>
          ask[1] ? question -> (serve ; answer[1] ! result)
        )
      }
    }
    process Main {
      in  x : double @ 2 ms
      in  z : double @ 10 ms
      out y : double @ 2 ms
      out w : double @ 10 ms
      communication {
        server : Server
        fast   : Fast
        slow   : Slow
        channel askFast    : double
        channel askSlow    : double
        channel answerFast : double
        channel answerSlow : double
        var one   : double = 0
        var other : double = 0
        one -> fast.x
        other -> slow.x
        fast.y -> y
        slow.y -> w
        askFast -> server.ask[0]
        askSlow -> server.ask[1]
        server.answer[0] -> answerFast
        server.answer[1] -> answerSlow
      }
      composition { <order> }
    }
    """
)  # fmt: skip
FAST = "mu (x ? one ; askFast ! one ; <wait> answerFast ? one ; fast)"
SLOW = "mu (z ? other ; askSlow ! other ; answerSlow ? other ; slow)"


def served(order: str, choice: str = "[]", wait: str = "") -> str:
    order = order.replace("fast", FAST).replace("slow", SLOW).replace("<wait>", wait)
    return SERVED.replace("<order>", order).replace("<choice>", choice)


@pytest.mark.parametrize("choice", ["[]", "[]>"])
@pytest.mark.parametrize(
    "order",
    ["fast || slow || server", "fast ||> server ||> slow", "slow ||> fast ||> server", "server ||> slow ||> fast"],
)
def test_loops_with_requests_keep_their_bounds(order: str, choice: str) -> None:
    network = with_bench(served(order, choice), ["x", "z"], ["y", "w"], "1 ms")
    report = timing_report(network)
    assert report.is_schedulable is True
    loops = by_name(report)
    assert {name: loop.partners for name, loop in loops.items()} == {"fast": ("server",), "slow": ("server",)}
    periods = {"Main.fast": 2 * MS, "Main.slow": 10 * MS, "Main.server.serve": 2 * MS}
    found = longest(network, wcets(network).__getitem__, periods, 60 * MS)
    for name, loop in loops.items():
        # Its own work, and the requests that the other one may have made before.
        assert found[f"Main.{name}"] <= (loop.response or 0)
        assert (loop.response or 0) <= 1600 * US


def test_a_client_counts_the_service_as_its_own_work() -> None:
    loops = by_name(report_of(served("fast || slow || server")))
    assert (loops["fast"].work, loops["slow"].work) == (300 * US, 500 * US)


def test_a_client_that_keeps_the_server_waiting_blocks_others_without_bound() -> None:
    report = report_of(served("fast || slow || server", wait="x ? one ;"))
    assert report.is_schedulable is None
    reasons = [refusal.reason for refusal in report.refusals]
    assert any("it waits at `askSlow` without bound" in reason or "answerFast" in reason for reason in reasons), reasons


def test_reading_an_overwriting_channel_gets_advice() -> None:
    text = (
        law("First", "100 us") + law("Second", "100 us") +
        """
        process Main {
          in  x : double @ 1 ms
          in  z : double @ 10 ms
          out y : double @ 10 ms
          communication {
            first  : First
            second : Second
            channel passed : double overwrite 1
            var own   : double = 0
            var taken : double = 0
            x -> first.x
            first.y -> passed
            taken -> second.x
            second.y -> y
          }
          composition { mu first || mu (z ? own ; passed ? taken ; second) }
        }
        """
    )  # fmt: skip
    (refusal,) = report_of(text).refusals
    reason = "it waits at `passed` without bound: no other process is certain to write it before the next sample"
    assert refusal.reason == reason
    assert refusal.help.startswith("read `passed` in an alternative with the sample, which keeps the last value")
