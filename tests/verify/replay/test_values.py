"""The values of a replay: those that the environment offers, and how they are shown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cspdiag.model.types import INT, IntType, RealType, TimeType, Type
from cspdiag.verify.runs.values import Values
from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture
from tests.support.verifying import answers_to

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


def test_values_are_reported_as_the_text_writes_them(
    cspdiag: Command,  # noqa: F811
    tmp_path: Path,
) -> None:
    (tmp_path / "case.csp").write_text(STRUCTS)
    file, trace = str(tmp_path / "case.csp"), str(tmp_path / "trace.json")
    assert cspdiag("verify", file, "--trace-out", trace).code == 1
    assert "pose  Pose(x = 1.0, mode = Mode.run, since = 3 ms)\n" in cspdiag("run", file, "--replay", trace).err


@pytest.mark.parametrize(
    ("reported", "kind", "offered"),
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
def test_a_range_is_offered_as_one_of_its_numbers(reported: str, kind: Type, offered: list[int]) -> None:
    assert Values(None, ()).candidates(kind, reported) == offered


@pytest.mark.parametrize(
    ("text", "kind", "offered"),
    [
        ("30..40", INT, [30, 0, 128, (1 << 63) - 1, -(1 << 63)]),
        ("2", IntType(bits=8), [2, 0, 127, -128]),
        (None, IntType(bits=8), [0, 1, 127, -128]),
        ("0.0", RealType(), [0.0, 128.0]),
        ("1 ms", TimeType(), [1_000_000, (1 << 63) - 1, -(1 << 63)]),
    ],
)
def test_numbers_at_which_operations_fault_are_tried_last(text: str | None, kind: Type, offered: list[float]) -> None:
    assert Values(None, (), (0, 128, 128.0, (1 << 63) - 1)).candidates(kind, text) == offered


def test_a_counterexample_shows_what_the_environment_offered() -> None:
    """The proof knows a range, and the program reads the port once more while it waits: the values are those of the
    steps.
    """
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


WRITES = """process Spec {
  out o : int
  composition { o ! 1 }
}

process P {
  out o : int
  composition { o ! 2 }
}

assert P refines Spec
"""
COPIES = """process Spec {
  in i : int
  out o : int
  communication { var x : int = 0 }
  composition { mu (i ? x ; o ! x) }
}

process P {
  in i : int
  out o : int
  communication { var x : int = 0 }
  composition { mu (i ? x ; o ! x % 1000) }
}

assert P refines Spec
"""
INSIDE = """process P {
  communication {
    channel c : int
    var v : int = 0
  }

  composition { (c ! 1 ; c ! 2 ; c ! 3) || (c ? v ; c ? v) || (mu wait 1 ms) }
}

assert P deadlock free
"""


@pytest.mark.parametrize(
    ("text", "fixed", "difference"),
    [
        (WRITES, ("o ! 2", "o ! 1"), "after 0 of 1 step, the trace has `2` at `o` in step 1, and the program `1`"),
        (COPIES, ("x % 1000", "x"), "after 1 of 2 steps, the trace has `0` at `o` in step 2, and the program `1000`"),
        (INSIDE, ("c ! 2", "c ! 77"), "after 1 of 2 steps, the trace has `2` at `c` in step 2, and the program `77`"),
    ],
)
def test_a_program_with_other_values_does_not_do_what_the_trace_says(
    cspdiag: Command,  # noqa: F811
    tmp_path: Path,
    text: str,
    fixed: tuple[str, str],
    difference: str,
) -> None:
    program, trace = tmp_path / "case.csp", tmp_path / "trace.json"
    program.write_text(text)
    assert cspdiag("verify", program, "--trace-out", trace).code == 1
    assert cspdiag("run", program, "--replay", trace).code == 0
    program.write_text(text.replace(*fixed))
    result = cspdiag("run", program, "--replay", trace)
    assert result.code == 1
    assert result.err.endswith(f"not replayed: {difference}\n")


@pytest.mark.parametrize(
    ("reported", "code"), [("2", 0), ("77", 1), (None, 0), ("..3", 0), ("3..", 1), ("(one value)", 0)]
)
def test_a_trace_may_leave_values_open(
    cspdiag: Command,  # noqa: F811
    tmp_path: Path,
    reported: str | None,
    code: int,
) -> None:
    program, trace = tmp_path / "case.csp", tmp_path / "trace.json"
    program.write_text(INSIDE)
    assert cspdiag("verify", program, "--trace-out", trace).code == 1
    whole = json.loads(trace.read_text())
    whole["steps"][1]["value"] = reported
    trace.write_text(json.dumps(whole))
    assert cspdiag("run", program, "--replay", trace).code == code
