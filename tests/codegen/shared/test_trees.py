"""Generators decide on trees: nothing inspects text that has been generated."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

CODEGEN = Path(__file__).parents[3] / "cspdiag" / "codegen"


def containing(language: str, pattern: str) -> set[str]:
    """The modules of a language that contain a pattern, except for those that print its trees."""
    paths = (path.relative_to(CODEGEN / language) for path in (CODEGEN / language).rglob("*.py"))
    found = {path.as_posix() for path in paths if re.search(pattern, (CODEGEN / language / path).read_text("utf-8"))}
    return {path for path in found if not path.startswith("text/")}


def test_only_the_length_of_an_expression_is_needed() -> None:
    assert containing("python", r"\.flat\b") == {"fast/values.py"}
    assert len(re.findall(r"\.flat\b", (CODEGEN / "python/fast/values.py").read_text("utf-8"))) == 1


@pytest.mark.parametrize(
    ("language", "parsing"),
    [
        # Indexes in the names of instances, and hand-written modules.
        ("python", {"plain/instances.py", "plain/external.py"}),
        # The structures of the kernel and of hand-written headers, whose sizes are computed from their text, their
        # macros, what files include, what a linker sees of the kernel and of hand-written files, where lines of
        # finished files break, and what compilers say.
        (
            "c",
            {f"interface/{name}.py" for name in ("api", "declarations", "directives", "lengths", "tokens")}
            | {f"package/{name}.py" for name in ("includes", "linkage", "folding", "line_document", "messages")}
            | {"laws/macros_by_hand.py"},
        ),
    ],
)
def test_patterns_are_for_names_and_files_of_others(language: str, parsing: set[str]) -> None:
    assert containing(language, r"^import re$|^from re import|(?m:^import re$)") == parsing
