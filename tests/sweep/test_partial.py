"""The file of a sweep that is not finished."""

from __future__ import annotations

import random
import resource
from pathlib import Path

import pytest

from cspdiag.base import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.sweep.partial import PartialTable, ResumeError
from cspdiag.sweep.plan import Plan, Request, plan_sweep
from cspdiag.sweep.programs import identity_of
from cspdiag.sweep.result import Result
from cspdiag.syntax.parser import parse
from tests.sweep.programs import HEATER

LAW_IN_C = 'submodel Law c "law.c" { in a : double out b : double }'
RESULT = Result("failed", 0.1 + 0.2, 'a text, with "quotes"', (1 / 3, None))


@pytest.fixture(scope="module")
def plan() -> Plan:
    source = SourceFile(name="heater.csp", text=HEATER)
    request = Request(
        source=source, given={"gain": "1:2:9"}, measures=["max(power)", "min(power)"], environment=None, until=1
    )
    return plan_sweep(request, read_source)


def opened(plan: Plan, folder: Path, *, resume: bool = True, version: str = "1") -> PartialTable:
    return PartialTable(plan, folder / "table.csv", resume=resume, version=version)


def test_results_are_read_as_they_were_written(plan: Plan, tmp_path: Path) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        table.add(7, RESULT)
        table.add(2, RESULT)
    with opened(plan, tmp_path) as table:
        assert table.known == {7: RESULT, 2: RESULT}


@pytest.mark.parametrize("lost", [1, 5, 30])
def test_a_line_that_was_cut_is_written_again(plan: Plan, tmp_path: Path, lost: int) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        table.add(7, RESULT)
        table.add(2, RESULT)
        path = table.path
    path.write_bytes(path.read_bytes()[:-lost])
    with opened(plan, tmp_path) as table:
        assert table.known == {7: RESULT}
        table.add(3, RESULT)
    with opened(plan, tmp_path) as table:
        assert table.known == {7: RESULT, 3: RESULT}


@pytest.mark.parametrize("seed", range(40))
def test_a_damaged_line_is_not_used(plan: Plan, tmp_path: Path, seed: int) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        for run in (7, 2, 5):
            table.add(run, RESULT)
        path = table.path
    lines = path.read_bytes().splitlines(keepends=True)
    chance = random.Random(seed)
    damaged = bytearray(lines[3])
    match chance.randrange(3):
        case 0:
            damaged[chance.randrange(len(damaged) - 1)] ^= 1 + chance.randrange(15)
        case 1:
            del damaged[chance.randrange(len(damaged) - 1)]
        case _:
            damaged[:-1] = bytes(len(damaged) - 1)
    path.write_bytes(b"".join((*lines[:3], damaged, *lines[4:])))
    with opened(plan, tmp_path) as table:
        assert table.known == {7: RESULT, 5: RESULT}
        assert set(table.damaged) in ({4}, {4, 5})  # A byte became a line end.
        table.add(2, RESULT)
    with opened(plan, tmp_path) as table:
        assert table.known == {7: RESULT, 5: RESULT, 2: RESULT}


def test_a_file_without_results_is_not_kept(plan: Plan, tmp_path: Path) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        head = table.path.read_bytes()
    assert not table.path.exists()
    table.path.write_bytes(head[:-3])  # The process was killed.
    with opened(plan, tmp_path, resume=False, version="2") as table:
        table.add(1, RESULT)
    with opened(plan, tmp_path, version="2") as table:
        assert table.known == {1: RESULT}


def test_two_results_of_one_run_are_refused(plan: Plan, tmp_path: Path) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        table.add(2, RESULT)
        table.add(2, RESULT)
    with opened(plan, tmp_path) as table:
        assert table.known == {2: RESULT}
        table.add(2, Result("terminated", 1.0, "", (1.0, 2.0)))
    with pytest.raises(ResumeError, match=r"partial:5: has another result of run 2 .* remove the file"):
        opened(plan, tmp_path)


def test_another_version_makes_another_sweep(plan: Plan, tmp_path: Path) -> None:
    with opened(plan, tmp_path, resume=False) as table:
        table.add(7, RESULT)
    with pytest.raises(ResumeError, match="belongs to another sweep"):
        opened(plan, tmp_path, version="2")
    with pytest.raises(ResumeError, match="has results of an interrupted sweep"):
        opened(plan, tmp_path, resume=False)


def token_of(text: str) -> str:
    source = SourceFile(name="heater.csp", text=text)
    request = Request(source=source, given={"gain": "1:2:9"}, measures=["max(power)"], environment=None, until=1)
    return plan_sweep(request, read_source).token("1")


def test_comments_and_layout_make_no_other_sweep() -> None:
    other = HEATER.replace("\n", "\n\n  // Of the heater.\n", 3).replace(" = ", "  =  ")
    assert other != HEATER
    assert token_of("/* Warm. */ " + other) == token_of(HEATER)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("100 ms", "100ms"),
        ("/// Its mass follows from its volume.", "/// Its mass depends on its volume."),
    ],
)
def test_layout_inside_a_literal_and_documentation_make_no_other_sweep(before: str, after: str) -> None:
    assert before in HEATER
    assert token_of(HEATER.replace(before, after)) == token_of(HEATER)


@pytest.mark.parametrize(
    ("before", "after"), [("100 ms", "100 us"), ("4 * gain", "4.0 * gain"), ("t - 10", "t - 11"), ("House", "Home")]
)
def test_what_a_program_says_makes_another_sweep(before: str, after: str) -> None:
    assert before in HEATER
    assert token_of(HEATER.replace(before, after)) != token_of(HEATER)


def test_the_body_of_a_submodel_makes_another_sweep(tmp_path: Path) -> None:
    body = tmp_path / "law.c"
    tree = parse(SourceFile(name=str(tmp_path / "law.csp"), text=LAW_IN_C), Report())
    body.write_text("one")
    first = identity_of([tree])
    body.write_text("other")
    assert first != identity_of([tree])


def test_what_a_body_in_c_includes_makes_another_sweep(tmp_path: Path) -> None:
    tree = parse(SourceFile(name=str(tmp_path / "law.csp"), text=LAW_IN_C), Report())
    (tmp_path / "law.c").write_text('#include "law.h"\n#include "absent.h"\n')
    (tmp_path / "law.h").write_text('  # include "tables/gains.h"\n')
    gains = tmp_path / "tables" / "gains.h"
    gains.parent.mkdir()
    gains.write_text('#include "../law.h"\n#include "factor.h"\n')
    factor = gains.with_name("factor.h")
    factor.write_text("#define FACTOR 1.0\n")
    first = identity_of([tree])
    assert first == identity_of([tree])
    factor.write_text("#define FACTOR 2.0\n")
    assert first != identity_of([tree])


def test_a_full_disk_is_an_error_with_the_name_of_the_file(plan: Plan, tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    with opened(plan, tmp_path, resume=False) as table:
        table.add(1, RESULT)
        size = table.path.stat().st_size
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 10, before[1]))
        try:
            with pytest.raises(OSError, match="File too large") as caught:
                table.add(2, RESULT)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert caught.value.filename == str(table.path)
    with opened(plan, tmp_path) as table:
        assert table.known == {1: RESULT}
