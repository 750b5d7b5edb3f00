"""``cspdiag margins``: the table, the picture, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.analyses.margins.programs import INTEGRATOR
from tests.cli.conftest import Command


@pytest.fixture
def loop(tmp_path: Path) -> Path:
    path = tmp_path / "loop.csp"
    path.write_text(INTEGRATOR.format(gain=10.0, latch=""))
    return path


def test_a_stable_loop(cspdiag: Command, loop: Path) -> None:
    result = cspdiag("margins", loop)
    assert result.code == 0
    head, row, *_ = result.out.splitlines()
    assert head.split() == ["loop", "period", "closed", "loop", "gain", "phase", "delay", "modulus", "crossover"]
    assert " ".join(row.split()) == "law.u 10 ms stable 10 20.0 dB 81.4 deg 142 ms 0.87 10 rad/s"


def test_an_unstable_loop_fails(cspdiag: Command, loop: Path) -> None:
    result = cspdiag("margins", "--set", "T=200ms", loop)
    assert result.code == 1
    assert "UNSTABLE" in result.out


def test_json(cspdiag: Command, loop: Path) -> None:
    result = cspdiag("margins", "--format", "json", "--largest-period", "stable", loop)
    assert result.code == 0
    report = json.loads(result.out)
    assert report["environment"] == "Bench"
    (found,) = report["loops"]
    assert found["stable"] is True
    assert found["gain"] == pytest.approx(10, rel=1e-3)
    assert found["largest_period"]["constant"] == "T"
    assert found["largest_period"]["period"] == pytest.approx(0.1, rel=0.01)


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_a_bode_picture(cspdiag: Command, loop: Path, tmp_path: Path, kind: str) -> None:
    picture = tmp_path / f"bode.{kind}"
    assert cspdiag("margins", "--plot", picture, loop).code == 0
    assert picture.read_bytes()[:5] == {"svg": b"<?xml", "png": b"\x89PNG\r"}[kind]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--largest-period", "much"), "a margin is 30deg"),
        (("--plot", "bode.txt"), "the name must end in"),
        (("--plot", "nowhere/bode.svg"), "there is no folder"),
        (("--environment", "Moon"), "Moon"),
        (("--set", "T"), "NAME=VALUE"),
        (("--at", "plant.x=1", "--at", "plant.x=2"), "plant.x is set twice: to 1.0 and to 2.0"),
        (("--at", "plant.v=1"), "`Bench` has no state plant.v (it has: plant.x)"),
        *(
            (("--at", f"plant.x={value}"), f"--at plant.x={value}: expected NAME=VALUE, the value a finite number")
            for value in ("fast", "nan", "1e400", "-inf", "1_0", "0x1", "\u0663")
        ),
        *(
            (("--largest-period", margin), f"not {margin!r}")
            for margin in ("nan", "nandeg", "1e400", "infdB", "1e6dB", "0", "0ms")
        ),
    ],
)
def test_wrong_usage(cspdiag: Command, loop: Path, options: tuple[str, ...], reason: str) -> None:
    result = cspdiag("margins", *options, loop)
    assert result.code == 2
    assert reason in result.err
    assert result.out == ""


def test_a_program_without_a_plant_is_refused(cspdiag: Command, loop: Path) -> None:
    loop.write_text(loop.read_text().partition("submodel Plant")[0])
    result = cspdiag("margins", loop)
    assert result.code == 2
    assert "no environment, and so no plant" in result.err


def test_a_program_with_errors_shows_them(cspdiag: Command, loop: Path) -> None:
    loop.write_text(loop.read_text().replace("mu law", "mu lw"))
    result = cspdiag("margins", loop)
    assert result.code == 1
    assert "error[" in result.err


def test_a_period_that_is_a_number_cannot_be_searched(cspdiag: Command, loop: Path) -> None:
    loop.write_text(loop.read_text().replace("@ T", "@ 10 ms"))
    result = cspdiag("margins", "--largest-period", "30deg", loop)
    assert result.code == 2
    assert "make it a `const`" in result.err


def test_a_part_that_no_loop_has_in_its_path_is_refused(cspdiag: Command, loop: Path) -> None:
    assert cspdiag("margins", "--loop", "nothing", loop) == (
        2, "", "cspdiag: --loop nothing: no loop has this in its path (there is `law.u`)\n",
    )  # fmt: skip
    assert "(did you mean `law.u`?)" in cspdiag("margins", "--loop", "lwa.u", loop).err


@pytest.mark.parametrize("part", ["law", "law.u", "w.u", "Main.law"])
def test_a_loop_is_chosen_by_any_part_of_its_path(cspdiag: Command, loop: Path, part: str) -> None:
    assert cspdiag("margins", "--loop", part, loop) == cspdiag("margins", loop)


def test_no_loop_is_reported(cspdiag: Command, loop: Path) -> None:
    loop.write_text(INTEGRATOR.format(gain=0.0, latch=""))
    for options in ((), ("--loop", "law")):
        result = cspdiag("margins", *options, loop)
        assert result.code == 1
        assert result.out.startswith("no loop goes through `Bench`")


def test_a_law_without_margins_is_no_success(cspdiag: Command, loop: Path) -> None:
    """Neither together with a stable loop nor alone."""
    text = loop.read_text()
    loop.write_text(text.replace("mu law", "mu (law ; u ! 0)"))
    result = cspdiag("margins", loop)
    assert result.code == 1
    assert "`law` has no margins: " in result.out
    assert "loop.csp:4:" in result.out
