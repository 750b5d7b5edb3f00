"""``cspdiag draw`` in the formats of graphs."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Command

JIWY = Path(__file__).parents[4] / "models/jiwy/jiwy.csp"


@pytest.mark.parametrize(
    ("options", "name", "begins"),
    [
        (["--format", "dot"], "Jiwy.dot", "digraph"),
        (["--format", "mermaid"], "Jiwy.mmd", "flowchart LR"),
        (["--format", "graphml"], "Jiwy.graphml", "<?xml"),
        (["-o", "a.gv"], "a.gv", "digraph"),
        (["-o", "a.mermaid"], "a.mermaid", "flowchart LR"),
        (["--format", "mermaid", "-o", "a.txt"], "a.txt", "flowchart LR"),
        (["--format", "dot", "-o", "folder/"], "folder/Jiwy.dot", "digraph"),
    ],
)
def test_draw_writes_the_graph(
    cspdiag: Command,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    name: str,
    begins: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cspdiag("draw", JIWY, *options) == (0, "", f"wrote {name}\n")
    assert (tmp_path / name).read_text().startswith(begins)
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    ("options", "refused"),
    [
        (["--all"], "--all is for pictures: dot has the whole network as text"),
        (["--check"], "--check is for pictures"),
        (["--depth", "2"], "--depth is for pictures"),
        (["--process", "A", "--process", "B"], "dot has the network of one process"),
        (["--process", "Jiwi"], "did you mean `Jiwy`?"),
        (["-o", "a.svg"], "-o a.svg contradicts --format dot"),
        (["-o", "a.mmd"], "-o a.mmd contradicts --format dot"),
    ],
)
def test_options_that_a_graph_does_not_have_are_refused(
    cspdiag: Command,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    refused: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    result = cspdiag("draw", JIWY, "--format", "dot", *options)
    assert result.code == 2
    assert refused in result.err
    assert list(tmp_path.iterdir()) == []


def test_a_program_with_errors_has_no_graph(cspdiag: Command, tmp_path: Path) -> None:
    (tmp_path / "broken.csp").write_text("process A {\n  composition { nobody }\n}\n")
    result = cspdiag("draw", tmp_path / "broken.csp", "-o", tmp_path / "a.dot")
    assert result.code == 1
    assert "E0204" in result.err
    assert not (tmp_path / "a.dot").exists()
