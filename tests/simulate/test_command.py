"""``cspdiag run``."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cspdiag.cli.main import main

MODELS = Path(__file__).parents[2] / "models"


def test_run_writes_what_was_requested_and_says_so(heater: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = heater.parent
    outputs = {"record": "out.csv", "trace": "out.jsonl", "plot": "out.png"}
    options = [part for option, name in outputs.items() for part in (f"--{option}", str(folder / name))]
    assert main(["run", str(heater), *options]) == 0
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "ended by itself at 480 ms" in shown.err
    for name in outputs.values():
        assert str(folder / name) in shown.err
        assert (folder / name).stat().st_size > 0
    assert json.loads((folder / "out.jsonl").read_text().splitlines()[0])["channel"] == "Oven.temperature"


def test_quiet_run_says_nothing(heater: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(heater), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--record", "out.xls"], "the name must end in .csv, .npz, .mcap or .parquet"),
        (["--plot", "nowhere/out.svg"], "there is no folder nowhere"),
        (["--environment", "Banch"], "no environment `Banch`"),
        (["--for", "soon"], "soon"),
        (["--set", "chamber"], "a setting is NAME=VALUE"),
        (["--set", "chamber.ambiant=3"], "chamber.ambiant"),
        (["--target", "cobol"], "invalid choice"),
        (["-O2"], "-O2"),
    ],
)
def test_wrong_use_is_reported_in_one_line(
    heater: Path, options: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(heater), *options]) == 2
    shown = capsys.readouterr().err
    assert reason in shown
    assert shown.count("\n") == 1


def test_program_without_environment_says_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "open.csp"
    path.write_text(
        "process Open {\n  in level : int @ 1 ms\n  communication { var x : int = 0 }\n  composition { mu level ? x "
        "}\n}\n"
    )
    assert main(["run", str(path)]) == 2
    assert "`Open` has no environment to run in" in capsys.readouterr().err


def test_errors_of_the_program_end_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "wrong.csp"
    path.write_text("process Open { composition { nobody } }\n")
    assert main(["run", str(path)]) == 1
    assert "nobody" in capsys.readouterr().err


def test_deadlock_is_reported_with_its_cycle(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(MODELS / "dining" / "deadlock.csp")]) == 1
    shown = capsys.readouterr().err
    assert "deadlock at 10 ms" in shown
    for number in range(5):
        assert f"SymmetricTable.philosopher[{number}]" in shown
    assert "table.csp:" in shown


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_releases_outputs_and_closes_recordings(heater: Path, number: signal.Signals) -> None:
    """The button is not pressed, so only the signal ends the run; it is sent when the program has long begun."""
    endless = heater.read_text().replace("time > 0.4<s>", "time > 400<s>").replace("480 ms", "480 s")
    begins = heater.parent / "begins"
    (heater.parent / "tell.py").write_text(
        "from pathlib import Path\n\n\nclass Tell:\n    def __init__(self):\n"
        f"        Path({str(begins)!r}).touch()\n\n    def calculate(self):\n        return 0.0\n"
    )
    endless = endless.replace(
        "environment Bench for Oven step 5 ms {", "environment Bench for Oven on miss count {\n tell : Tell"
    )
    heater.write_text(f'submodel Tell python "tell.py:Tell" {{ out x : double }}\n{endless}')
    record = heater.parent / "out.csv"
    command = [sys.executable, "-m", "cspdiag", "run", str(heater), "--real-time", "--record", str(record)]
    child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not begins.exists() and child.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(1)
    assert child.poll() is None
    child.send_signal(number)
    error = child.communicate(timeout=30)[1]
    assert child.returncode == 128 + number
    assert f"Oven in Bench: stopped by {number.name} at" in error
    assert "Traceback" not in error
    assert record.read_text().startswith("time,temperature,button,power\n0.")
