"""``cspdiag run --json``: how a run ended, and its ports in figures."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Command

PROGRAM = """\
const limit : double = 25
enum Mode { idle, on }
struct Pose { x : double y : double }

process Loop {
  in  e : double @ 10 ms
  in  pose : Pose @ 10 ms
  out u : double @ 10 ms
  out mode : Mode
  out late : time

  communication {
    var v : double
    var p : Pose
  }

  composition {
    mode ! Mode.idle ; late ! 1500 us ; mode ! Mode.on ; mu (e ? v ; pose ? p ; u ! v / (limit - 10 * v))
  }
}

submodel Plant {
  out e : double
  out pose : Pose
  e = time / 10 ms
  pose = Pose(x = time / 1 s, y = -1)
}

environment Bench for Loop step 10 ms {
  plant : Plant
  plant.e -> e
  plant.pose -> pose
  u -> _
  mode -> _
  late -> _
}
"""


def ended(cspdiag: Command, folder: Path, *options: str) -> tuple[int, dict[str, Any]]:
    program, path = folder / "loop.csp", folder / "ended.json"
    program.write_text(PROGRAM)
    code = cspdiag("run", program, "--json", path, *options).code
    found: dict[str, Any] = json.loads(path.read_text())
    return code, found


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("-O0",),
        ("-O", "reference"),
        ("--quiet", "--record", "run.csv"),
        pytest.param(
            ("--target", "c"),
            marks=pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler"),
        ),
    ],
)
def test_the_ports_are_the_same_on_all_targets(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    code, found = ended(cspdiag, tmp_path, "--for", "20ms", *options)
    assert code == 0
    assert {name: value for name, value in found.items() if name != "ports"} == {
        "process": "Loop",
        "environment": "Bench",
        "successful": True,
        "ended": "time limit",
        "time": 0.02,
        "error": None,
        "missed": {},
    }
    # At the end the outputs are released.
    assert found["ports"] == {
        "e": {"values": 2, "changes": 1, "least": 1.0, "greatest": 2.0, "last": 2.0},
        "pose.x": {"values": 2, "changes": 1, "least": 0.01, "greatest": 0.02, "last": 0.02},
        "pose.y": {"values": 2, "changes": 0, "least": -1.0, "greatest": -1.0, "last": -1.0},
        "u": {"values": 2, "changes": 1, "least": 0.0, "greatest": 1 / 15, "last": 0.0},
        "mode": {"values": 3, "changes": 3, "last": "idle"},
        "late": {"values": 2, "changes": 2, "least": 0.0, "greatest": 0.0015, "last": 0.0},
    }


def test_a_run_that_fails_has_its_error_and_what_passed_until_then(cspdiag: Command, tmp_path: Path) -> None:
    code, found = ended(cspdiag, tmp_path, "--set", "limit=20")
    assert (code, found["successful"], found["ended"], found["time"]) == (1, False, "failed", 0.02)
    assert found["error"].startswith("Fault: division by zero, in Loop")
    assert found["ports"]["e"]["values"] == 2


def test_a_program_with_errors_is_not_run_and_leaves_no_file(cspdiag: Command, tmp_path: Path) -> None:
    program, path = tmp_path / "wrong.csp", tmp_path / "ended.json"
    program.write_text(PROGRAM.replace("? v", "? w"))
    assert cspdiag("run", program, "--json", path).code == 1
    assert not path.exists()


def test_its_file_is_no_other_one(cspdiag: Command, tmp_path: Path) -> None:
    program = tmp_path / "loop.csp"
    program.write_text(PROGRAM)
    result = cspdiag("run", program, "--json", tmp_path / "a.json", "--trace", tmp_path / "a.json")
    assert (result.code, "--trace and --json name one file" in result.err) == (2, True)
    assert "the name must end in .json" in cspdiag("run", program, "--json", tmp_path / "a.txt").err
