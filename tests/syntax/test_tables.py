"""The parse tables: no conflicts, the same language as Lark's own parser, and a cache that never does harm."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from lark import Lark
from lark import logger as lark_logger

from cspdiag.base.files import resources
from cspdiag.syntax.parse import tables
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS
from tests.syntax.generate import program, sprinkled

SEEDS = st.integers(0, 2**40).map(Random)


def test_the_grammar_has_no_conflicts(caplog: pytest.LogCaptureFixture) -> None:
    level = lark_logger.level
    lark_logger.setLevel(logging.DEBUG)
    lark_logger.propagate = True
    try:
        with caplog.at_level(logging.DEBUG):
            Lark(resources.grammar(), parser="lalr", maybe_placeholders=True, debug=True)
    finally:
        lark_logger.setLevel(level)
    assert "conflict" not in caplog.text


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(SEEDS)
def test_lark_itself_reads_the_same_programs(random: Random) -> None:
    # Lark's contextual lexer takes contextual words for keywords in more places than this one.
    tokens = program(random)
    assume(CONTEXTUAL_KEYWORDS.isdisjoint(tokens))
    _LARK.parse(sprinkled(tokens, random))


_LARK = Lark(resources.grammar(), parser="lalr", maybe_placeholders=True)


def use_cache(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    monkeypatch.setenv("LOCALAPPDATA", str(folder))


def test_the_cache_is_written_once_and_read_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_cache(monkeypatch, tmp_path)
    first = tables.load()
    (written,) = (tmp_path / "cspdiag").iterdir()
    monkeypatch.setattr(tables, "build", lambda grammar: pytest.fail("built again"))
    assert tables.load() == first
    assert [path.name for path in (tmp_path / "cspdiag").iterdir()] == [written.name]


@pytest.mark.parametrize("damage", [b"", b"nonsense", b"\x00" * 10_000])
def test_a_damaged_cache_is_made_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, damage: bytes) -> None:
    use_cache(monkeypatch, tmp_path)
    first = tables.load()
    (written,) = (tmp_path / "cspdiag").iterdir()
    written.write_bytes(damage)
    anew = tables.load()
    assert (len(anew.actions), anew.words, anew.patterns) == (len(first.actions), first.words, first.patterns)
    assert len(written.read_bytes()) > 10_000


def test_a_cache_that_cannot_be_written_is_ignored(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    use_cache(monkeypatch, blocked)
    assert tables.load().rules


def test_reading_a_program_does_not_import_lark() -> None:
    program_text = (
        "import sys\n"
        "from cspdiag.base import Report, SourceFile\n"
        "from cspdiag.syntax.parser import parse\n"
        "parse(SourceFile(name='case.csp', text='const A = 1'), Report())\n"
        "print(sorted({'lark', 'numpy', 'networkx', 'jinja2', 'control'} & set(sys.modules)))\n"
    )
    tables.load()
    result = subprocess.run([sys.executable, "-c", program_text], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
