"""Links that open programs in the playground."""

from __future__ import annotations

from pathlib import Path

import pytest

from distribution.site.playground import fragment, program_in, program_of

ROOT = Path(__file__).parents[3]
FILES = {"a.csp": 'import "b.csp"\n/// ü\nprocess A {}\n', "b.csp": "const x = 1\n"}


def test_a_link_holds_a_program() -> None:
    link = fragment(FILES, "a.csp")
    assert link.startswith("#code=")
    assert set(link[6:]) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_")
    assert program_in(link) == (FILES, "a.csp")


@pytest.mark.parametrize("wrong", ["", "#", "#code=", "#code=!", "#code=AAAA", "#file=x"])
def test_what_is_not_a_program_is_refused(wrong: str) -> None:
    with pytest.raises(ValueError, match="not a program"):
        program_in(wrong)


def test_a_program_has_the_files_that_it_imports() -> None:
    files, main = program_of(ROOT / "models/jiwy/jiwy.csp")
    assert (sorted(files), main) == (["jiwy.csp", "laws.csp", "plant.csp"], "jiwy.csp")
    files, main = program_of(ROOT / "models/jiwy_mujoco/contacts.csp")
    assert main == "jiwy_mujoco/contacts.csp"
    assert {"jiwy/jiwy.csp", "jiwy/laws.csp"} <= set(files)
