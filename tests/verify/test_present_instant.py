"""Proofs do not follow instants: a condition on ``now`` may hold or not, and a refutation is a run of the program."""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

PROGRAM = """exception Ends

process Main {{
  in x : double @ 10 ms

  communication {{
    var v : double = 0
    var n : int    = 0
    var late : bool = false
    var pause : time = 1 ms
  }}

  composition {{
    {composition}
  }}
}}

assert Main {claim}
"""

ALL_BUT_PROVED = {"refuted", "unknown"}
NEVER_STOPS = "wait 5 ms ; (if now < 5 ms then stop)"
STOPS = "wait 5 ms ; (if now >= 5 ms then stop)"


@pytest.mark.parametrize(
    ("composition", "claim", "allowed"),
    [
        (NEVER_STOPS, "deadlock free", {"proved", "unknown"}),
        (NEVER_STOPS, "terminates", {"proved", "unknown"}),
        (STOPS, "deadlock free", {"refuted", "unknown"}),
        (STOPS, "terminates", {"refuted", "unknown"}),
        ("mu (wait 5 ms - now ; n := 1)", "livelock free", {"refuted", "unknown"}),
        ("mu (wait 5 ms ; n := 1) until now >= 15 ms", "livelock free", {"proved", "unknown"}),
        ("mu (wait 5 ms ; n := 1) until now >= 15 ms", "terminates", {"proved", "unknown"}),
        ("mu (x ? v ; wait 100 ms - now)", "schedulable", {"refuted", "unknown"}),
        ("wait until 5 ms ; (if now < 5 ms then stop)", "deadlock free", {"proved", "unknown"}),
        ("wait until 5 ms ; (if now >= 5 ms then stop)", "deadlock free", {"refuted", "unknown"}),
        ("mu (wait until pause ; n := 1)", "livelock free", {"refuted"}),
        ("mu (wait until now + 5 ms ; n := 1)", "livelock free", {"proved", "unknown"}),
        ("mu (wait until now + 5 ms ; n := 1) until now >= 15 ms", "terminates", {"proved", "unknown"}),
        ("mu (x ? v ; wait until 100 ms)", "schedulable", {"refuted", "unknown"}),
        ("at 5 ms -> (if now < 5 ms then stop)", "deadlock free", {"proved", "unknown"}),
        ("at 5 ms -> (if now >= 5 ms then stop)", "deadlock free", {"refuted", "unknown"}),
        ("(at 5 ms -> stop []> after 6 ms -> skip)", "deadlock free", {"refuted", "unknown"}),
        ("(at 5 ms -> skip []> after 6 ms -> stop)", "deadlock free", {"proved", "unknown"}),
        ("mu (at 5 * pause -> n := 1 [] x ? v -> skip)", "livelock free", {"refuted", "unknown"}),
        ("mu (x ? v -> skip []> at 5 * pause -> n := 1)", "livelock free", {"refuted", "unknown"}),
        ("(mu (x ? v)) interrupt at 55 ms -> n := 1", "terminates", {"proved", "unknown"}),
        ("(mu (x ? v)) interrupt at 55 ms -> stop", "deadlock free", {"refuted", "unknown"}),
        ("mu (x ? v -> skip [] at 25 ms -> wait 30 ms)", "schedulable", {"refuted", "unknown"}),
        ("mu (x ? v -> skip []> at 25 ms -> stop)", "schedulable", {"refuted", "unknown"}),
        ("mu (wait until n * -1 ms ; n := 1)", "livelock free", {"refuted"}),
        ("while now < 3 ms do wait 1 ms", "terminates", {"proved", "unknown"}),
        ("mu (wait 1 ms) until now > 3 ms", "terminates", {"proved", "unknown"}),
        ("mu (x ? v) until now >= 2 s", "terminates", {"proved", "unknown"}),
        ("mu (wait 1 ms ; if 3 ms < now then raise Ends)", "terminates", {"proved", "unknown"}),
        ("mu (when now > 3 ms & skip -> n := 1 []> after 1 ms -> skip) until n == 1", "terminates", {"unknown"}),
        ("mu (wait 1 ms ; late := now > 3 ms) until late", "terminates", {"proved", "unknown"}),
        ("mu (wait 1 ms ; n := 6 / (if now == 4 ms then 0 else 1))", "terminates", {"proved", "unknown"}),
        ("wait until 7 ms ; mu (wait 1 ms ; n := 1)", "terminates", {"refuted"}),
        ("(if now < 3 ms then n := 1) ; mu (wait 1 ms ; n := 1)", "terminates", {"refuted"}),
        ("mu (wait 1 ms ; pause := now)", "terminates", {"refuted"}),
        ("(n := (if now >= 3 ms then 6 / n else 2) ; stop) catch Fault -> skip", "deadlock free", ALL_BUT_PROVED),
        ("(late := now >= 3 ms and 6 / n > 1 ; stop) catch Fault -> skip", "deadlock free", ALL_BUT_PROVED),
        ("(late := now < 3 ms or 6 / n > 1 ; stop) catch Fault -> skip", "deadlock free", ALL_BUT_PROVED),
        (
            "(n := (if now >= 3 ms then 6 / n else 7 / n) ; stop) catch Fault -> skip",
            "deadlock free",
            {"proved", "unknown"},
        ),
    ],
)
def test_no_answer_about_the_present_instant_is_wrong(composition: str, claim: str, allowed: set[str]) -> None:
    assert answer_to(PROGRAM.format(composition=composition, claim=claim)).outcome in allowed
