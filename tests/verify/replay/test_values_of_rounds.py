"""Iterations that a replay adds are shown with their values, directions and lines, like those of the trace itself."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cspdiag.proofs.counterexamples.table import table
from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture
from tests.support.verifying import answer_to

COUNTER = """process Main {
  in  x : int PERIOD
  out o : int
  communication {
    var v : int = 0
    var t : time = 0 s
    var k : int8 = START
  }
  composition {
    (mu (BODY)) catch Fault -> stop
  }
}
assert Main deadlock free
"""
READS = "x ? v ; k := k + 1 ; o ! int(k)"


def counter(start: int, body: str = READS, *, period: str = "") -> str:
    return COUNTER.replace("START", str(start)).replace("BODY", body).replace("PERIOD", period)


def rows(text: str) -> list[str]:
    answer = answer_to(text)
    assert answer.counterexample is not None, answer.reason
    return [" ".join(line.split()) for line in table(answer.counterexample).splitlines()[1:-1]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (counter(126, period="@ 10 ms"), ["1 sample x 0 ?10", "2 o 127 !10", "3 sample x 0 ?10"]),
        (
            counter(0),
            [
                *["1 x 0 ?10", "2 o 1 !10", "3-252 125 more rounds, x 0, o 2 … 126 ?!10"],
                *["253 x 0 ?10", "254 o 127 !10", "255 x 0 ?10"],
            ],
        ),
        (
            counter(125, "k := k + 1 ; o ! int(k) ;\n     wait 1 ms ; (if k == 0 then x ? v)"),
            ["1 o 126 !10", "2 wait 1 ms *11", "3 o 127 !10", "4 wait 1 ms *11"],
        ),
        (
            counter(100, "k := k + 1 ; o ! int(k) ;\n     wait 1 ms ; (if k == 0 then x ? v)"),
            [
                *["1 o 101 !10", "2 wait 1 ms *11", "3-52 25 more rounds, o 102 … 126 !10 *11"],
                *["53 o 127 !10", "54 wait 1 ms *11"],
            ],
        ),
        (
            counter(124, "k := k + 1 ; o ! int(k) ; t := t + 5 ms ;\n     wait until t ; (if k == 0 then x ? v)"),
            [row for n in (1, 2, 3) for row in (f"{2 * n - 1} o {124 + n} !10", f"{2 * n} wait until t *11")],
        ),
    ],
)
def test_rows_of_added_rounds(text: str, expected: list[str]) -> None:
    assert rows(text) == expected


LAW = """submodel Ramp {
  in x : double
  out u : double
  out full : bool
  state s : double = 0
  next s = s + 0.25
  u = s
  full = s > 8
}
process Main {
  in  x : double @ 10 ms
  out u : double
  communication { ramp : Ramp
    x -> ramp.x
    ramp.u -> u
    ramp.full -> full : bool }
  composition { (mu ramp until full) ; stop }
}
assert Main deadlock free
"""


def test_what_a_law_writes_in_added_rounds() -> None:
    assert [row for row in rows(LAW) if "rounds" in row or row.startswith(("2 ", "68 "))] == [
        "2 u 0.0 !17",
        "3-66 32 more rounds, x 0.0, u 0.25 to 8 ?!17",
        "68 u 8.25 !17",
    ]


def test_machines_have_values_and_places_of_added_rounds(cspdiag: Command, tmp_path: Path) -> None:  # noqa: F811
    (tmp_path / "case.csp").write_text(counter(120))
    trace = tmp_path / "trace.json"
    cspdiag("verify", str(tmp_path / "case.csp"), "--trace-out", str(trace))
    steps = json.loads(trace.read_text())["steps"]
    (entry,) = (step for step in steps if step["kind"] == "rounds")
    assert entry["times"] == 1, "of which each has another value"
    assert [step["value"] for step in entry["steps"]] == [text for k in range(121, 128) for text in (str(k), "0")]
    for step in entry["steps"]:
        (party,) = step["parties"]
        assert (party["process"], party["line"]) == ("Main", 10)
        assert party["before"] == {"Main.x": "waits to read x", "Main.o": "waits to write o"}[step["channel"]]
    replay = cspdiag("run", str(tmp_path / "case.csp"), "--replay", str(trace))
    assert (replay.code, replay.err.count("  o  ")) == (0, 7)
