"""Drivers in C: devices behind ports, in virtual time and against the clock."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.cli.main import main
from cspdiag.simulate.native import run as native
from tests.c_kernel.building import HERE, need
from tests.conformance.sources import network_of, read

FOLDER = HERE / "devices" / "drivers"
DROVE = [f"drive {5 + 0.01 * tick + 0.5 * tick:g}" for tick in range(1, 10)]
"""The measured level is half the number of samples, the simulated one grows by 1 a second."""


@pytest.fixture(params=["", "-O1"])
def run(request: pytest.FixtureRequest, capfd: pytest.CaptureFixture[str]) -> list[str]:
    """The lines of a run against the clock."""
    need("cc")
    options = [request.param] if request.param else []
    assert main(["run", str(FOLDER / "tank.csp"), "--target", "c", "--real-time", *options]) == 0
    return capfd.readouterr().err.splitlines()


def test_drivers_are_opened_called_and_closed(run: list[str]) -> None:
    assert [line for line in run if line.startswith(("open", "close", "drive", "lamp"))] == [
        r"open 3 0.5 left \\ tank 1",
        *DROVE,
        "lamp 0 1",
        "lamp 1 1",
        "drive -1",
        "lamp 0 0",
        "lamp 1 0",
        "close 3 after 10 samples",
    ]


@pytest.mark.parametrize("level", [0, 1])
def test_a_driver_in_virtual_time(level: int) -> None:
    need("cc")
    network = network_of(read(str(FOLDER / "tank.csp")))
    found = native.simulate(network, read, level=level)
    assert found.outcome.ended == "terminated"
    values = [item.value for item in found.communications if item.channel.endswith("drive")]
    assert values == pytest.approx([5 + 0.01 * tick + 0.5 * tick for tick in range(1, 10)])


def test_a_device_that_cannot_be_opened_is_named_and_nothing_is_driven(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    need("cc")
    monkeypatch.setenv("NO_BOARD", "1")
    assert main(["run", str(FOLDER / "tank.csp"), "--target", "c", "--real-time"]) == 1
    shown = capfd.readouterr()
    assert "the device board could not be opened, in tank.csp:38" in shown.out + shown.err
    assert "drive" not in shown.err
    assert "close" not in shown.err


@pytest.mark.parametrize(
    ("wanted", "given", "message"),
    [
        ("double level;", "float level;", "the member `level` of `struct board` has to be `double`, as the port is"),
        ("bool lamps[2];", "int lamps[2];", "the member `lamps` of `struct board` has to be `bool[2]`, as the port is"),
        (
            "bool lamps[2];",
            "bool lamps[1];",
            "the member `lamps` of `struct board` has to be `bool[2]`, as the port is",
        ),
        (
            "int64_t channel,",
            "int32_t channel,",
            "`board_open` has to be `bool board_open(struct board *, int64_t, double",
        ),
        (
            "void board_write_lamps(struct board *self, uint32_t index)",
            "void board_write_lamps(struct board *self, uint8_t index)",
            "`board_write_lamps` has to be `void board_write_lamps(struct board *, uint32_t)`, as its definition is",
        ),
        (
            "bool board_read_level(struct board *self)",
            "int board_read_level(struct board *self)",
            "`board_read_level` has to be `bool board_read_level(struct board *)`, as its definition is",
        ),
        (
            "void board_close(struct board *self)",
            "void board_close(const struct board *self)",
            "`board_close` has to be `void board_close(struct board *)`, as its definition is",
        ),
    ],
)
def test_a_member_of_another_type_is_refused(
    wanted: str, given: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    need("gcc")
    for path in FOLDER.iterdir():
        (tmp_path / path.name).write_text(path.read_text(encoding="utf-8").replace(wanted, given), encoding="utf-8")
    assert main(["run", str(tmp_path / "tank.csp"), "--target", "c"]) == 1
    assert message in capsys.readouterr().err


def test_python_has_no_devices_in_c(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(FOLDER / "tank.csp")
    files = pipeline.generate(network_of(read(path)), read, "python", 0)
    assert not any("real" in name for name in files if "/environments/" in name)
    assert main(["run", path, "--target", "python"]) == 2
    assert "the driver `Board` is written in C, which Python cannot call" in capsys.readouterr().err


def test_the_library_of_a_program_has_no_drivers() -> None:
    files = pipeline.generate(network_of(read(str(FOLDER / "tank.csp"))), read, "c", 0)
    program = files["Makefile"].partition("PROGRAM")[2].partition("\n\n")[0]
    assert "network.c" in program or "network.o" in program
    assert "board" not in program
