"""Outputs that cannot be written are refused before the work begins, under their own names."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cspdiag.base.files.whole import write_whole
from cspdiag.cli.support.failure import UsageError
from cspdiag.cli.support.files import written
from tests.cli.conftest import Command

PROGRAM = """
process Main {
  in  a : double @ 1 ms
  out y : double @ 1 ms
  communication { var x : double = 0 }
  composition { mu (a ? x ; y ! x ; wait 2 ms) }
}

submodel Source {
  out y : double
  y = time / 1<s>
}

environment Bench for Main {
  source : Source
  source.y -> a
  y -> _
}
"""


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "main.csp"
    path.write_text(PROGRAM)
    return path


@pytest.mark.parametrize(
    ("command", "option", "name"),
    [
        ("run", "--record", "out.csv"),
        ("run", "--trace", "out.json"),
        ("run", "--plot", "out.svg"),
        ("run", "--draw-deadlock", "out.svg"),
        ("margins", "--plot", "out.svg"),
        ("verify", "--trace-out", "out.json"),
        ("verify", "--draw", "out.svg"),
        ("verify --timing", "--gantt", "out.svg"),
        ("draw", "-o", "out.svg"),
        ("draw", "--book", "out.html"),
        ("draw --all", "-o", "out/"),
        ("compile", "-o", "out"),
        ("bench", "--json", "out.json"),
    ],
)
def test_an_output_is_refused_by_its_own_name(
    cspdiag: Command, program: Path, monkeypatch: pytest.MonkeyPatch, command: str, option: str, name: str
) -> None:
    """Only what the file system says of the folder matters; the user who runs the tests may be allowed everything."""

    def refuse(path: str, flags: int, mode: int = 0o777) -> int:
        raise PermissionError(13, "Permission denied", path)

    monkeypatch.setattr(written, "os", _Refusing(refuse))
    files = [] if command == "bench" else [program]
    result = cspdiag(*command.split(), option, name, *files)
    assert result.code == 2
    assert result.out == ""
    assert f"{option} {name}: no file can be written in" in result.err
    assert "permission denied" in result.err
    assert os.listdir() == ["main.csp"]


@pytest.mark.parametrize("ending", ["/", "/.", "/.."])
@pytest.mark.parametrize(
    ("command", "option", "name"),
    [
        ("run", "--record", "out.csv"),
        ("run", "--trace", "out.json"),
        ("run", "--plot", "out.svg"),
        ("run", "--draw-deadlock", "out.svg"),
        ("run", "--replay", "out.json"),
        ("margins", "--plot", "out.svg"),
        ("verify", "--trace-out", "out.json"),
        ("verify", "--draw", "out.svg"),
        ("verify --timing", "--gantt", "out.svg"),
        ("verify --timing", "--wcet-from", "out.json"),
        ("draw", "--book", "out.html"),
        ("bench", "--json", "out.json"),
    ],
)
def test_a_folder_is_not_accepted_as_a_file(
    cspdiag: Command, program: Path, command: str, option: str, name: str, ending: str
) -> None:
    """A slash at the end of a path is dropped, so the file would have been written."""
    files = [] if command == "bench" else [program]
    result = cspdiag(*command.split(), option, name + ending, *files)
    assert (result.code, result.out) == (2, "")
    assert name + ending in result.err
    assert os.listdir() == ["main.csp"]


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("compile", "-o"),
        ("compile", "--templates"),
        ("examples ring", "-o"),
        ("draw", "-o"),
        ("draw", "--book"),
        ("diff", "-o"),
        ("run", "--inputs"),
        ("run", "--tune"),
        ("verify --timing", "--wcet-from"),
        ("mcp", ""),
    ],
)
def test_an_empty_name_is_not_that_of_the_present_folder(
    cspdiag: Command, program: Path, command: str, option: str
) -> None:
    """As of a variable that a script has not set."""
    given = ["", program] if option and not command.startswith("examples") else [""]
    result = cspdiag(*command.split(), *([option] if option else []), *given)
    assert (result.code, result.out) == (2, "")
    assert "expected the name of a file" in result.err
    assert "not ''" in result.err
    assert os.listdir() == ["main.csp"]


class _Refusing:
    """The module ``os``, except for opening files."""

    def __init__(self, refuse: object) -> None:
        self.open = refuse

    def __getattr__(self, name: str) -> object:
        return getattr(os, name)


def test_an_impossible_place_for_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "file").write_text("")
    for path, reason in (
        ("folder.csv", "is a directory"),
        ("nowhere/out.csv", "there is no folder"),
        ("out.xls", "must end in .csv or .npz"),
        ("file/out.csv", "there is no folder"),
    ):
        with pytest.raises(UsageError, match=reason):
            written.require_file("--record", tmp_path / path, (".csv", ".npz"))
    with pytest.raises(UsageError, match="is in the way"):
        written.require_folder("-o", str(tmp_path / "file/build"))
    written.require_folder("-o", str(tmp_path / "new/build"))
    written.require_file("--record", tmp_path / "out.csv", (".csv",))
    written.require_file("--record", "/dev/null")
    assert sorted(os.listdir(tmp_path)) == ["file", "folder.csv"]


def test_a_file_that_cannot_be_written_later_is_reported_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as raised:
        write_whole(tmp_path / "gone" / "out.csv", b"")
    assert raised.value.filename == str(tmp_path / "gone" / "out.csv")


def test_a_wrong_duration_lists_the_units(cspdiag: Command, program: Path) -> None:
    result = cspdiag("run", program, "--for", "1h")
    assert result.code == 2
    assert "ns, us, ms, s, min" in result.err


def test_help_of_compile_lists_the_targets(cspdiag: Command) -> None:
    shown = " ".join(cspdiag("compile", "--help").out.split())
    assert "python, c, fmu, promela, cspm" in shown


def test_a_folder_behind_a_link_that_leads_nowhere_is_refused(cspdiag: Command, program: Path) -> None:
    Path("out").symlink_to("nowhere")
    result = cspdiag("compile", program, "-o", "out")
    assert (result.code, result.err) == (2, "cspdiag: -o out: is a symbolic link that leads nowhere\n")
