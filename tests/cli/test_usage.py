"""Wrong usage and unreadable files: exit code 2 and one line; every other outcome has its exit code, too."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag import __version__
from cspdiag.cli.main import VERBS
from cspdiag.cli.verbs import check
from tests.cli.conftest import Command


def one_line(text: str) -> bool:
    return text.count("\n") == 1 and text.endswith("\n") and text.startswith("cspdiag: ")


@pytest.mark.parametrize(
    "arguments",
    [
        ["verfy"],
        ["--nonsense"],
        ["check"],
        ["check", "--nonsense", "x.csp"],
        ["check", "--format", "yaml", "x.csp"],
        ["check", "missing.csp"],
        ["check", "."],
        ["check", "a\0b.csp"],
        ["check", ""],
        ["check", "/dev/zero"],
        ["compile", "missing.csp"],
        ["compile", "--emit", "assembly", "x.csp"],
        ["fmt", "missing.csp"],
        ["explain", "E9999"],
        ["explain", "--markdown", "E0101"],
        ["new", "3d"],
        ["new", ""],
        ["new", "class"],
    ],
    ids=repr,
)
def test_wrong_usage_ends_with_one_line(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    result = cspdiag(*arguments)
    assert result.code == 2
    assert result.out == ""
    assert one_line(result.err)


def test_a_near_verb_is_suggested(cspdiag: Command) -> None:
    assert "did you mean check?" in cspdiag("chekc").err


@pytest.mark.parametrize("data", [b"\xff\xfe", b"process \0", bytes(range(256))], ids=repr)
def test_a_binary_file_is_not_a_program(cspdiag: Command, tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "binary.csp"
    path.write_bytes(data)
    result = cspdiag("check", path)
    assert result.code == 2
    assert one_line(result.err)
    assert "text" in result.err


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every file")
def test_a_file_without_permission(cspdiag: Command, good: Path) -> None:
    good.chmod(0)
    result = cspdiag("check", good)
    assert result.code == 2
    assert one_line(result.err)


def test_line_ends_and_byte_order_marks_do_not_matter(cspdiag: Command, good: Path, bad: Path) -> None:
    text = bad.read_bytes()
    expected = cspdiag("check", bad)
    bad.write_bytes(b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"))
    assert cspdiag("check", bad) == expected


def test_the_overview_lists_the_verbs(cspdiag: Command) -> None:
    result = cspdiag("--help")
    assert result.code == 0
    assert all(f"  {verb} " in result.out for verb in VERBS)
    assert "example:" in result.out
    nothing = cspdiag()
    assert (nothing.code, nothing.out) == (2, result.out)


@pytest.mark.parametrize("verb", VERBS)
def test_the_help_of_a_verb_ends_with_an_example(cspdiag: Command, verb: str) -> None:
    result = cspdiag(verb, "--help")
    assert result.code == 0
    last = result.out.rstrip().splitlines()[-1]
    assert last.startswith(f"  cspdiag {verb}")


def test_the_version(cspdiag: Command) -> None:
    assert cspdiag("--version") == (0, f"cspdiag {__version__}\n", "")


def test_an_internal_error_says_what_to_report(cspdiag: Command, good: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise KeyError("lost")

    monkeypatch.setattr(check, "findings", fail)
    result = cspdiag("check", good)
    assert result.code == 3
    assert "Traceback" not in result.err
    for reported in ("internal error", __version__, "KeyError: 'lost'", "in fail", good.name):
        assert reported in result.err


_SMALL_MEMORY = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (80_000_000, 80_000_000))
from cspdiag.cli.main import main
sys.exit(main(["check", sys.argv[1]]))
"""


def test_too_little_memory_is_said(tmp_path: Path) -> None:
    large = tmp_path / "large.csp"
    cells = "\n".join(f"        cell{number} : Cell" for number in range(20_000))
    large.write_text(f"process Ring {{\n    communication {{\n{cells}\n    }}\n}}\n", encoding="utf-8")
    result = subprocess.run(
        [sys.executable, "-c", _SMALL_MEMORY, large], capture_output=True, text=True, timeout=120, check=False
    )
    assert (result.returncode, result.stderr) == (1, "cspdiag: the memory that this process may have is used up\n")


@pytest.mark.parametrize("arguments", [("check", "x.csp"), ("new", "arm"), ("fmt", "x.csp"), ("run", "x.csp")])
def test_a_folder_that_was_removed_is_said(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...]
) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    assert cspdiag(*arguments) == (2, "", "cspdiag: the present folder does not exist any more\n")


def test_ctrl_c_ends_quietly(cspdiag: Command, good: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "findings", interrupt)
    assert cspdiag("check", good) == (130, "", "")


def test_a_reader_that_closes_the_pipe_is_not_an_error() -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "cspdiag", "explain", "--markdown"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    errors = process.stderr.read()
    process.stderr.close()
    assert process.wait() == 141
    assert errors == b""


def test_a_terminal_without_the_characters_still_shows_the_message(good: Path) -> None:
    good.write_text("process Ü {")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    for style in ("text", "concise", "github"):
        result = subprocess.run(
            [sys.executable, "-m", "cspdiag", "check", "--format", style, good], env=environment, capture_output=True
        )
        assert result.returncode == 1
        assert b"E01" in result.stdout + result.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "x.csp", "--record", "a.csv", "--record", "b.csv"],
        ["run", "x.csp", "--plot", "a.svg", "--plot", "b.svg"],
        ["run", "x.csp", "--for", "1s", "--for", "2s"],
        ["verify", "x.csp", "--trace-out", "a", "--trace-out=b"],
        ["verify", "x.csp", "--process", "A", "--process", "B"],
        ["compile", "x.csp", "-o", "a", "--output", "b"],
        ["draw", "x.csp", "-o", "a.svg", "-o", "b.svg"],
        ["check", "x.csp", "--format", "json", "--format", "sarif"],
        ["margins", "x.csp", "--loop", "a", "--loop", "b"],
    ],
    ids=" ".join,
)
def test_no_option_is_lost(cspdiag: Command, arguments: list[str]) -> None:
    """Otherwise the first value would be ignored silently."""
    result = cspdiag(*arguments)
    assert result.code == 2
    assert "is given twice: " in result.err
    assert one_line(result.err)


def test_an_option_may_say_the_same_twice(cspdiag: Command, good: Path) -> None:
    assert cspdiag("check", good, "--format", "json", "--format=json").code == 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "x.csp", "--plot", "a.svg", "--draw-deadlock", "b/../a.svg"],
        ["run", "x.svg", "--plot", "x.svg"],
        ["verify", "x.csp", "--trace-out", "x.csp"],
        ["verify", "x.csp", "--trace-out", "a.svg", "--draw", "a.svg"],
        ["draw", "x.csp", "--book", "link.csp"],
    ],
    ids=" ".join,
)
def test_no_file_is_written_twice_or_over_the_program(
    cspdiag: Command, good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("b").mkdir()
    for name in ("x.csp", "x.svg"):
        Path(name).write_text(good.read_text())
    Path("link.csp").symlink_to("x.csp")
    result = cspdiag(*arguments)
    assert result.code == 2
    assert "name one file: " in result.err
    assert one_line(result.err)
    assert Path(arguments[1]).read_text() == good.read_text()


def test_a_run_of_negative_length_is_refused_with_that_reason(cspdiag: Command, good: Path) -> None:
    for arguments in (["--for", "-5s"], ["--for=-5s"]):
        done = cspdiag("run", str(good), *arguments)
        assert done.code == 2
        assert "a run cannot last -5s: write a positive duration" in done.err


@pytest.mark.parametrize("verb", ["draw", "verify"])
def test_the_processes_are_listed_where_none_is_near(cspdiag: Command, tmp_path: Path, verb: str) -> None:
    (tmp_path / "two.csp").write_text("process Left { composition { skip } }\nprocess Right { composition { skip } }\n")
    done = cspdiag(verb, str(tmp_path / "two.csp"), "--process", "Xyzzy")
    assert done.code == 2
    assert "(there is `Left`, `Right`)" in done.err
    assert "(did you mean `Right`?)" in cspdiag(verb, str(tmp_path / "two.csp"), "--process", "Rigth").err
