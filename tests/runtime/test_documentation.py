"""The programs of docs/runtime.md run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

_TEXT = (Path(__file__).parents[2] / "docs" / "runtime.md").read_text()
_PROGRAMS = re.findall(r"^## (.+?)$|```python\n(.*?)```", _TEXT, re.MULTILINE | re.DOTALL)


def _programs() -> list[object]:
    heading = ""
    found: list[object] = []
    for title, program in _PROGRAMS:
        heading = title or heading
        if program:
            found.append(pytest.param(program, id=heading))
    return found


@pytest.mark.parametrize("program", _programs())
def test_program_of_the_page(program: str) -> None:
    exec(compile(program, "docs/runtime.md", "exec"), {"__name__": "example"})
