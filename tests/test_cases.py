"""Runs the literate cases of ``tests/cases``; ``--update-cases`` rewrites what they expect."""

from __future__ import annotations

import pytest

from tests.literate import CASES, Case, actual, all_cases, update


def _identifier(case: Case) -> str:
    return f"{case.path.relative_to(CASES).with_suffix('')}: {case.title}"


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "case" in metafunc.fixturenames:
        if metafunc.config.getoption("--update-cases"):
            for path in sorted(CASES.rglob("*.md")):
                update(path)
        metafunc.parametrize("case", all_cases(), ids=_identifier)


def test_case(case: Case) -> None:
    place = f"{case.path.relative_to(CASES.parent.parent)}:{case.line}"
    assert case.files, f"{place} has no program"
    assert case.expectations, f"{place} expects nothing"
    for block in case.expectations:
        assert actual(case, block) == block.text, f"{place} says otherwise (pytest --update-cases shows the change)"
