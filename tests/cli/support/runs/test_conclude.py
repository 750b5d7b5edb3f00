"""Signals while the recordings of a run are written."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from time import sleep

import pytest

from cspdiag.cli.main import main
from cspdiag.cli.support.runs import conclude
from cspdiag.simulate.record.streamed.table import Table
from cspdiag.simulate.result import Run

PROGRAM = """
driver Card(stops: int) python "card.py:Card" { out level : double }

process Main {
  in  level : double @ 10 ms
  out valve : double @ 10 ms safe -1
  communication { var last : double = 0 }
  composition { mu (level ? last ; valve ! last) }
}

submodel Valve { in x : double }
const stops = 0
environment Bench for Main {
  card : Card(stops)
  sink : Valve
  card.level -> level
  valve -> sink.x
}
"""

CARD = """
import os
import signal


class Card:
    def __init__(self, *, stops):
        self.stops = stops

    def read(self, port):
        self.stops -= 1
        if self.stops == 0:
            os.kill(os.getpid(), signal.SIGTERM)
        return 1.0
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    (tmp_path / "main.csp").write_text(PROGRAM)
    (tmp_path / "card.py").write_text(CARD)
    close = Table.close

    def interrupted(self: Table, ended: str, time: int) -> None:
        os.kill(os.getpid(), signal.SIGHUP)
        close(self, ended, time)

    monkeypatch.setattr(Table, "close", interrupted)
    monkeypatch.chdir(tmp_path)
    return ["run", "main.csp", "--for", "1s", "--record", "main.csv", "--trace", "main.jsonl"]


def test_a_signal_ends_the_writing_of_a_run_that_ended_by_itself(
    run: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = signal.getsignal(signal.SIGHUP)
    assert main(run) == 128 + signal.SIGHUP
    reported = capsys.readouterr().err
    assert reported.endswith("cspdiag: stopped by SIGHUP before main.csv, main.jsonl had been written\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["card.py", "main.csp", "main.part.csv"]
    assert signal.getsignal(signal.SIGHUP) == before


def test_a_further_signal_does_not_affect_a_stopped_run(
    run: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*run, "--set", "stops=5"]) == 128 + signal.SIGTERM
    reported = capsys.readouterr().err
    assert "Main in Bench: stopped by SIGTERM at 50 ms" in reported
    assert "wrote main.csv, main.jsonl" in reported
    assert (tmp_path / "main.csv").read_text().splitlines()[-1].endswith(",-1.0")


def test_a_recording_that_takes_long_to_write_is_announced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(conclude, "_PATIENCE", 0.05)
    (tmp_path / "main.csp").write_text(PROGRAM)
    (tmp_path / "card.py").write_text(CARD)
    close = Table.close

    def slow(self: Table, ended: str, time: int) -> None:
        sleep(0.5)
        close(self, ended, time)

    monkeypatch.setattr(Table, "close", slow)
    file = tmp_path / "values.csv"
    assert main(["run", str(tmp_path / "main.csp"), "--for", "50ms", "--record", str(file)]) == 0
    assert f"cspdiag: writing {file}\n" in capfd.readouterr().err


def test_only_files_that_are_not_there_are_named_after_a_signal(
    run: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(self: Run, path: Path) -> None:
        os.kill(os.getpid(), signal.SIGHUP)

    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Run, "to_trace", interrupted)
    assert main(run) == 128 + signal.SIGHUP
    assert capsys.readouterr().err.endswith("cspdiag: stopped by SIGHUP before main.jsonl had been written\n")
    assert (tmp_path / "main.csv").exists()
