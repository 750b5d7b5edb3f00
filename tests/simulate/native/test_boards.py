"""Runs on emulated processors: the traces and the ends are those of the reference, and what is missing is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.simulate.native.boards import BOARDS
from tests.conformance.kit import judge, parsed
from tests.conformance.sources import JUST_AFTER, environments
from tests.conformance.targets import EMULATED, Target

DIVISION = """process Main {
  communication { var n : int = 3 }
  composition { mu (wait 1 ms ; n := 6 / n - 2) }
}
"""


@pytest.fixture(params=EMULATED.values(), ids=EMULATED)
def target(request: pytest.FixtureRequest) -> Target:
    target: Target = request.param
    reason = target.unavailable()
    if reason is not None:
        pytest.skip(reason)
    return target


@pytest.mark.parametrize(
    "name", ["models/jiwy/jiwy.csp", "models/emergency/emergency.csp", "models/dining/deadlock.csp"]
)
def test_the_trace_is_that_of_the_reference(target: Target, name: str) -> None:
    network = parsed(name)
    for environment in environments(network):
        verdict = judge(target, network, environment, 300_000_000 + JUST_AFTER, name)
        assert verdict.result == "equal", verdict.details


@pytest.fixture
def file(tmp_path: Path) -> str:
    path = tmp_path / "with space, and comma.csp"
    path.write_text(DIVISION)
    return str(path)


def test_faults_and_recordings_are_those_of_other_runs(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    if EMULATED["cortex-m4"].unavailable() is not None:
        pytest.skip("there is no emulator")
    reports = []
    for options in ([], ["--target", "c", "--on", "cortex-m4"]):
        assert main(["run", file, "--for", "10ms", *options]) == 1
        reports.append(capsys.readouterr().err.splitlines()[0])
    assert reports[0] == reports[1]
    assert "division by zero" in reports[1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--on", "cortex-m4"], "--on cortex-m4 needs --target c"),
        (["--on", "z80", "--target", "c"], "unknown board 'z80' (there are: cortex-m0, "),
        (["--on", "riscv32", "--target", "c", "--real-time"], "--real-time is not for --on"),
    ],
)
def test_what_cannot_be_is_refused(
    file: str, options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", file, *options]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("board", BOARDS)
def test_missing_tools_are_named(
    file: str, board: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert main(["run", file, "--target", "c", "--on", board, "--for", "1ms"]) == 1
    text = capsys.readouterr().err
    assert BOARDS[board].emulator[0] in text
    assert f"apt install {BOARDS[board].packages}" in text


def test_a_program_that_is_too_large_is_reported_in_two_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reason = EMULATED["cortex-m0"].unavailable()
    if reason is not None:
        pytest.skip(reason)
    file = tmp_path / "large.csp"
    buffers = "".join(f"    channel c{number} : int buffer 100000\n" for number in range(40))
    uses = " ; ".join(f"c{number} ! 1 ; c{number} ? v" for number in range(40))
    file.write_text(
        f"process Large {{\n  communication {{\n    var v : int = 0\n{buffers}  }}\n  composition {{ {uses} }}\n}}\n"
    )
    assert main(["run", str(file), "--target", "c", "--on", "cortex-m0"]) != 0
    report = capsys.readouterr().err
    assert "the program is too large for the board" in report
    assert "bytes of RAM more" in report
    assert len(report.splitlines()) == 2
