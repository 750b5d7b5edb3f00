"""``check --statistics`` and ``check --watch``."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.conftest import BAD, GOOD, Command

ROOT = Path(__file__).parents[4]


def test_statistics_count_by_code(cspdiag: Command, tmp_path: Path) -> None:
    one, two = tmp_path / "one.csp", tmp_path / "two.csp"
    one.write_text(BAD)
    two.write_text(BAD.replace("mu (given ? held ; taken ! hold)", "mu (given ? hold ; taken ! hold)"))
    result = cspdiag("check", "--statistics", one, two)
    assert result.code == 1
    count, code, *title = result.out.split()
    assert (count, code, bool(title)) == ("3", "E0204", True)
    (row,) = json.loads(cspdiag("check", "--statistics", "--format", "json", one, two).out)
    assert row == {"count": 3, "code": "E0204", "title": "an unknown name", "fixable": row["fixable"]}


def test_statistics_of_nothing_are_empty(cspdiag: Command, tmp_path: Path) -> None:
    (tmp_path / "good.csp").write_text(GOOD)
    result = cspdiag("check", "--statistics", tmp_path / "good.csp")
    assert (result.code, result.out) == (0, "")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--statistics", "--fix"), "--statistics counts what is found once"),
        (("--statistics", "--watch"), "--statistics counts what is found once"),
        (("--statistics", "--format", "sarif"), "--statistics has no format sarif"),
        (("--watch", "--fix"), "--watch follows files"),
        (("--watch", "-"), "--watch follows files"),
    ],
)
def test_options_that_contradict_each_other_are_refused(
    cspdiag: Command, tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    (tmp_path / "good.csp").write_text(GOOD)
    result = cspdiag("check", *options, tmp_path / "good.csp")
    assert result.code == 2
    assert message in result.err


def test_a_change_of_an_imported_file_is_checked_again_until_ctrl_c(tmp_path: Path) -> None:
    main, library = tmp_path / "main.csp", tmp_path / "library.csp"
    library.write_text(GOOD)
    main.write_text('import "library.csp"\n')
    log = tmp_path / "log"
    with log.open("w") as output:
        watching = subprocess.Popen(
            [sys.executable, "-m", "cspdiag", "check", "--watch", str(main)],
            stdout=output, stderr=output, env={**os.environ, "PYTHONPATH": str(ROOT)},
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )  # fmt: skip
    try:
        _wait_for(log, "0 errors, 0 warnings; watching 2 files")
        library.write_text(BAD)
        _wait_for(log, "error[E0204]")
        _wait_for(log, "1 error, 0 warnings; watching 2 files")
        library.unlink()
        _wait_for(log, "library.csp")
        library.write_text(GOOD)
        _wait_for(log, "0 errors, 0 warnings; watching 2 files", times=2)
        library.write_text(f'{GOOD}submodel Plant fmu "plant.fmu" {{ in a : double out b : double }}\n')
        _wait_for(log, "1 error, 0 warnings; watching 3 files")
        (tmp_path / "plant.fmu").write_text("not one")
        _wait_for(log, "1 error, 0 warnings; watching 3 files", times=2)
        library.write_text(GOOD)
        _wait_for(log, "0 errors, 0 warnings; watching 2 files", times=3)
        main.unlink()
        _wait_for(log, "0 errors, 0 warnings, 1 file not checked; watching 1 file")
    finally:
        watching.send_signal(signal.SIGINT)
        assert watching.wait(timeout=60) == 130
    assert "Traceback" not in log.read_text()


def _wait_for(log: Path, text: str, times: int = 1) -> None:
    for _ in range(600):
        if log.read_text().count(text) >= times:
            return
        time.sleep(0.1)
    pytest.fail(f"{text!r} is missing:\n{log.read_text()}")
