"""The use from Python."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.api import ProgramError
from cspdiag.network.lower import SelectionError
from cspdiag.settings import SettingError, parse_duration, split_setting

JIWY = Path(__file__).parents[1] / "models/jiwy/jiwy.csp"


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    path = tmp_path / "broken.csp"
    path.write_text("process A {\n  composition { nobody }\n}\n")
    return path


def test_a_program_is_loaded_checked_and_compiled() -> None:
    program = cspdiag.load(JIWY)
    assert program.check() == []
    assert program.network.top == "Jiwy"
    assert program.compile() == cspdiag.compile(str(JIWY))
    assert "jiwy/network.py" in program.compile()


def test_a_program_runs_with_settings() -> None:
    program = cspdiag.load(JIWY)
    run = program.run(environment="Bench", until="50 ms", set={"Tsv": "2 ms", "pan.inertia": 2e-3})
    assert run.outcome.time == 50_000_000
    instants = run.time("feedback_vertical")
    assert len(instants) == 25
    assert instants[1] - instants[0] == pytest.approx(0.002)
    assert len(program.run(until="50 ms").time("feedback_vertical")) == 50


def test_what_is_wrong_is_told(broken: Path) -> None:
    (diagnostic,) = cspdiag.check(broken)
    assert diagnostic.code == "E0204"
    with pytest.raises(ProgramError, match="nobody") as raised:
        cspdiag.compile(broken)
    assert raised.value.diagnostics == [diagnostic]


def test_what_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        cspdiag.load(tmp_path / "missing.csp")
    program = cspdiag.load(JIWY)
    with pytest.raises(SelectionError, match="Nowhere"):
        program.run(environment="Nowhere")
    for setting in ("Nothing", "pan.nothing", "nobody.inertia"):
        with pytest.raises(SettingError, match=setting):
            program.run(set={setting: 1})
    with pytest.raises(SettingError, match="Tsv"):
        program.run(set={"Tsv": "fast"})


def test_settings_are_names_and_values() -> None:
    assert split_setting(" Tsh = 10 ms ") == ("Tsh", "10 ms")
    for text in ("Tsh", "=1", "Tsh=", ""):
        with pytest.raises(SettingError, match="NAME=VALUE"):
            split_setting(text)
    assert parse_duration("1.5 ms") == 1_500_000
    with pytest.raises(SettingError):
        parse_duration("soon")
