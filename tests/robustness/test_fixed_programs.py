"""However a correct program is damaged, its fixes come to an end, leave nothing that has a fix, and make nothing worse.

``python -m tests.robustness.test_fixed_programs 5000`` tries 5000 programs.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from random import Random

from cspdiag.base import Diagnostic, SourceFile
from cspdiag.base.sources import read_source
from cspdiag.fix import fix
from cspdiag.pipeline import check
from tests.robustness.damage import damaged

PROGRAMS = 48

_HABITS = (
    (r":=", "="), (r"->", "=>"), (r"\bprocess\b", "procss"), (r"\bcomposition\b", "compositon"), (r"\bin\b", "input"),
    (r"\bout\b", "output"), (r"\bdouble\b", "real"), (r"\bint\b", "integer"), (r"\bbool\b", "boolean"),
    (r"\band\b", "&&"), (r"==", "="), (r"\*", "·"), (r" ms\b", " msec"), (r"\bnot ", "!"), (r"(?<=: int)$", ";"),
    (r"(?<=: double)$", ";"), (r"\?", "??"),
)  # fmt: skip
"""What people write who know other languages or type fast, in place of what."""


def mistaken(seed: int) -> tuple[str, str]:
    """The path of a program, and its text, damaged every third time, with typical mistakes and slips in it."""
    path, text = damaged(seed)
    random = Random(seed)
    if seed % 3:
        text = path.read_text(encoding="utf-8")
    for _ in range(random.randint(1, 4)):
        pattern, habit = random.choice((*_HABITS, (r"\b[a-z]{5,}\b", "")))
        places = list(re.finditer(pattern, text, re.MULTILINE))
        if places:
            place = random.choice(places)
            word = place[0]
            text = text[: place.start()] + (habit or word[0] + word[2] + word[1] + word[3:]) + text[place.end() :]
    return str(path), text


def mistakes(seed: int) -> tuple[list[str], bool]:
    """What is wrong with the fixes of a damaged program, and whether there were any."""
    path, text = mistaken(seed)
    source = SourceFile(name=path, text=text)
    found = check(source, read_source).report.diagnostics
    result = fix([source], read_source, str)
    if not any(each.edits for each in found):
        return ["changed without a fix"] * (len(result.files) + ([*map(str, result.left)] != [*map(str, found)])), False
    return list(_mistakes(source, found, result.left, [file.text for file in result.files])), True


def _mistakes(
    source: SourceFile, before: list[Diagnostic], left: tuple[Diagnostic, ...], texts: list[str]
) -> Iterator[str]:
    for prefix in ("E01",) if _count("E01", before) else ("E01", "E"):
        if _count(prefix, left) > _count(prefix, before):
            yield f"more errors {prefix}: {[*map(str, left)]}"
    for text in texts:
        fixed = SourceFile(name=source.name, text=text)
        if fix([fixed], read_source, str).files:
            yield "fixed once more"
        if [*map(str, check(fixed, read_source).report.diagnostics)] != [*map(str, left)]:
            yield "something else is left than was said"


def _count(prefix: str, found: list[Diagnostic] | tuple[Diagnostic, ...]) -> int:
    return sum(each.code.startswith(prefix) for each in found)


def test_fixes_of_damaged_programs_end_and_add_no_errors() -> None:
    answers = {seed: mistakes(seed) for seed in range(PROGRAMS)}
    assert {seed: wrong for seed, (wrong, _) in answers.items() if wrong} == {}
    assert sum(has_fixes for _, has_fixes in answers.values()) > PROGRAMS // 3


if __name__ == "__main__":
    failed = False
    for seed in range(int(sys.argv[1])):
        wrong, _ = mistakes(seed)
        failed |= bool(wrong)
        for line in wrong:
            print(seed, line)
    sys.exit(failed)
