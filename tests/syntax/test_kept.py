"""Trees that are kept from one command to the next."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from cspdiag.base import Report, SourceFile, Span
from cspdiag.base.files import resources
from cspdiag.base.record import field_names, is_record
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main
from cspdiag.syntax import kept, parser
from cspdiag.syntax.ast import SourceTree
from tests.literate import all_cases

ROOT = Path(__file__).parents[2]
TEXT = "process Main {\n  composition { skip }\n}\n"


@pytest.fixture(autouse=True)
def trees(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of kept trees."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    kept._code.cache_clear()
    return tmp_path / "cache" / "cspdiag" / "trees"


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the files that are parsed."""
    names = []
    parse = parser.parse

    def noted(source: SourceFile, report: Report) -> SourceTree:
        names.append(source.name)
        return parse(source, report)

    monkeypatch.setattr(parser, "parse", noted)
    return names


def structure(item: object) -> object:
    """Everything in a tree, as plain values."""
    if isinstance(item, Span):
        return item.source.name, item.start, item.end
    if isinstance(item, tuple):
        return tuple(map(structure, item))
    if is_record(item):
        return type(item), [(name, structure(getattr(item, name))) for name in field_names(item)]
    return type(item), item


def source(text: str = TEXT, name: str = "main.csp") -> SourceFile:
    return SourceFile(name=name, text=text)


@pytest.mark.parametrize("path", sorted(ROOT.glob("models/*/*.csp")), ids=lambda path: path.stem)
def test_a_kept_tree_is_the_tree(path: Path, parsed: list[str]) -> None:
    read = read_source(str(path))
    first, second = (kept.parse(read, Report()) for _ in range(2))
    assert parsed == [str(path)]
    assert first is not second
    assert structure(second) == structure(first) == structure(parser.parse(read, Report()))
    assert second.source is second.span.source is second.items[0].span.source


def test_a_check_says_the_same_with_kept_trees(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], parsed: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(kept, "MOST_FILES", 10_000)
    names = []
    for number, case in enumerate(all_cases()):
        for file, text in case.files.items():
            path = Path(f"case{number}", file)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            names.append(str(path))
    said = []
    for _ in range(2):
        code = main(["check", *names])
        said.append((code, *capsys.readouterr()))
    assert said[0] == said[1]
    assert len(set(parsed)) < len(parsed) < 1.5 * len(set(parsed)), "those with mistakes are parsed again"


def test_a_changed_text_is_parsed(parsed: list[str]) -> None:
    for text in (TEXT, TEXT, f"{TEXT}// a comment\n", TEXT):
        tree = kept.parse(source(text), Report())
        assert tree.source.text == text
    assert len(parsed) == 3


def test_the_name_of_a_file_is_part_of_its_tree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("main.csp", "./main.csp", str(tmp_path / "main.csp"), "main.csp"):
        assert kept.parse(source(name=name), Report()).span.file == name
    assert len(parsed) == 3


def test_mistakes_are_reported_each_time(trees: Path) -> None:
    for _ in range(2):
        report = Report()
        kept.parse(source("proces Main {}"), report)
        assert report.has_errors
    assert list(trees.iterdir()) == []


def test_other_code_makes_other_trees(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]) -> None:
    grammar = tmp_path / "csp.lark"
    grammar.write_text("start:")
    monkeypatch.setattr(resources, "grammar_file", lambda: str(grammar))
    for text in ("start: item", "start: item", "start: item*"):
        grammar.write_text(text)
        os.utime(grammar, ns=(1, 1))
        kept._code.cache_clear()
        kept.parse(source(), Report())
    assert len(parsed) == 2


def test_all_code_that_makes_trees_counts() -> None:
    program = "from cspdiag.base import *; from cspdiag.syntax.parser import parse; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {
        name.removeprefix("cspdiag.syntax.") for name in done.stdout.split() if name.startswith("cspdiag.syntax.")
    }
    counted = {Path(name).stem for name in kept._MADE_BY}
    only_describe_mistakes = {"diagnostics"}
    assert {name.partition(".")[0] for name in loaded} <= counted | only_describe_mistakes


def _nothing(data: bytes) -> bytes:
    return b""


def _half(data: bytes) -> bytes:
    return data[: len(data) // 2]


def _one_bit(data: bytes) -> bytes:
    return data[:-100] + bytes([data[-100] ^ 1]) + data[-99:]


@pytest.mark.parametrize("damage", [_nothing, _half, _one_bit])
def test_a_damaged_tree_is_made_again(trees: Path, parsed: list[str], damage: Callable[[bytes], bytes]) -> None:
    kept.parse(source(), Report())
    (file,) = trees.iterdir()
    file.write_bytes(damage(file.read_bytes()))
    assert structure(kept.parse(source(), Report())) == structure(parser.parse(source(), Report()))
    kept.parse(source(), Report())
    assert len(parsed) == 3


def test_a_cache_that_others_can_write_into_is_not_used(trees: Path, parsed: list[str]) -> None:
    trees.parent.mkdir(parents=True)
    trees.parent.chmod(0o777)
    for _ in range(2):
        kept.parse(source(), Report())
    assert len(parsed) == 2
    assert not trees.exists()


def test_neither_standard_input_nor_a_huge_text_is_kept(trees: Path) -> None:
    kept.parse(source(name="-"), Report())
    kept.parse(source(TEXT + "// " + "x" * 200_000), Report())
    assert not trees.exists() or list(trees.iterdir()) == []


def test_there_are_never_too_many(trees: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]) -> None:
    monkeypatch.setattr(kept, "MOST_FILES", 6)
    for number in range(20):
        kept.parse(source(name=f"{number}.csp"), Report())
        assert len(list(trees.iterdir())) <= 6
    kept.parse(source(name="19.csp"), Report())
    assert len(parsed) == 20
