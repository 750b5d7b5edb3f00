"""The values of a replay: those that the environment offers, and how they are told."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.model.types import INT, TimeType, Type
from cspdiag.simulate.replay.values import Values
from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture
from tests.verifying import answers_to

STRUCTS = """enum Mode { idle, run }

struct Pose {
  x: double
  mode: Mode
  since: time
}

process Holds {
  out pose : Pose

  composition { pose ! Pose(x = 1, mode = Mode.run, since = 3 ms) ; stop }
}

assert Holds deadlock free
"""


def test_values_are_told_as_the_text_writes_them(
    cspdiag: Command,  # noqa: F811
    tmp_path: Path,
) -> None:
    (tmp_path / "case.csp").write_text(STRUCTS)
    file, trace = str(tmp_path / "case.csp"), str(tmp_path / "trace.json")
    assert cspdiag("verify", file, "--trace-out", trace).code == 1
    assert "pose  Pose(x = 1.0, mode = Mode.run, since = 3 ms)\n" in cspdiag("run", file, "--replay", trace).err


@pytest.mark.parametrize(
    ("told", "kind", "offered"),
    [
        ("..1", INT, [0, 1]),
        ("30..40", INT, [30]),
        ("-9..-7", INT, [-7]),
        ("2", INT, [2]),
        ("1 ms", TimeType(), [1_000_000]),
        ("5 ms..", TimeType(), [5_000_000]),
        ("none", INT, []),
    ],
)
def test_a_range_is_offered_as_one_of_its_numbers(told: str, kind: Type, offered: list[int]) -> None:
    assert Values(None, ()).candidates(kind, told) == offered


def test_counterexample_tells_what_the_environment_offered() -> None:
    """The proof knows a range, and the program reads the port once more while it waits: the values are those of the steps."""
    text = """process Sensor {
  in level : int @ 10 ms
  in key   : int

  communication {
    var now  : int = 0
    var code : int = 0
  }

  composition { (mu level ? now until now > 40) ; key ? code ; if code > 7 and code < 9 then stop }
}

assert Sensor deadlock free
"""
    (answer,) = answers_to({"case.csp": text})
    assert (answer.outcome, answer.replayed) == ("refuted", True)
    assert answer.counterexample is not None
    assert [(step.channel, step.value) for step in answer.counterexample.steps] == [
        ("Sensor.level", "41"),
        ("Sensor.key", "8"),
    ]
