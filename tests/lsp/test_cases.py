"""Runs the literate cases of ``tests/lsp/cases`` with a client; ``--update-cases`` rewrites what they expect.

A case is a section with a program, in which ``§`` marks the place of the request, and a block for each feature.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.literate import MAIN, Case, cases_of
from tests.lsp.editor import Client, Editor

CASES = Path(__file__).parent / "cases"


def _all() -> list[Case]:
    return [case for path in sorted(CASES.glob("*.md")) for case in cases_of(path)]


@pytest.mark.parametrize("case", _all(), ids=lambda case: f"{case.path.stem}: {case.title}")
@pytest.mark.asyncio(loop_scope="module")
async def test_case(case: Case, client: Client, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    for name, text in case.files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    editor = Editor(client, tmp_path)
    await editor.open(MAIN, case.files[MAIN])
    found = {}
    for block in (block for block in case.blocks if block.language != "csp"):
        found[block] = await editor.answer(block.language)
    await editor.close()
    assert found, f"{case.path.name}:{case.line} expects nothing"
    if request.config.getoption("--update-cases"):
        _update(case, {block.text: text for block, text in found.items()})
        return
    for block, text in found.items():
        assert text == block.text, f"{case.path.name}:{case.line} says otherwise"


def _update(case: Case, found: dict[str, str]) -> None:
    """Rewrite the blocks of a case; the places of those before it may have changed."""
    text = case.path.read_text(encoding="utf-8")
    (present,) = (each for each in cases_of(case.path) if each.title == case.title)
    for block in reversed([block for block in present.blocks if block.language != "csp"]):
        text = text[: block.start] + found[block.text] + text[block.end :]
    case.path.write_text(text, encoding="utf-8")
