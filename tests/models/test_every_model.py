from __future__ import annotations

import pytest

import cspdiag
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.models.programs import DURATIONS, MODELS, all_files, programs, run


@pytest.mark.parametrize("name", all_files())
def test_checks_cleanly(name: str) -> None:
    diagnostics = cspdiag.load(MODELS / name).check()
    assert list(diagnostics) == []


@pytest.mark.parametrize("name", all_files())
def test_formats_to_itself(name: str) -> None:
    text = (MODELS / name).read_text(encoding="utf-8")
    tree = parse(SourceFile(name=name, text=text), Report())
    assert tree is not None
    assert format_tree(tree) == text


@pytest.mark.parametrize("name", programs())
def test_gives_the_same_trace_twice(name: str) -> None:
    first, second = (run(name, until=DURATIONS.get(name)) for _ in range(2))
    assert len(first.communications) > 0
    assert first.communications == second.communications
    assert first.outcome.time == second.outcome.time
    assert first.outcome.ended == second.outcome.ended


def test_every_model_has_a_program_of_its_name_and_a_description() -> None:
    for folder in MODELS.iterdir():
        if folder.is_dir():
            program = {"jiwy_mujoco": "contacts"}.get(folder.name, folder.name)
            assert (folder / f"{program}.csp").is_file()
            assert (folder / "README.md").is_file()
