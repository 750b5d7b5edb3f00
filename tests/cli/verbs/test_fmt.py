from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.cli.conftest import GOOD, Command

UGLY = GOOD.replace("  in  given : int\n  out taken : int", "in given:int out   taken:int")


@pytest.fixture
def ugly(good: Path) -> Path:
    good.write_text(UGLY)
    return good


@pytest.fixture
def pretty(cspdiag: Command) -> str:
    result = cspdiag("fmt", "-", stdin=UGLY)
    assert (result.code, result.err) == (0, "")
    return result.out


def test_a_file_is_formatted_in_place(cspdiag: Command, ugly: Path, pretty: str) -> None:
    assert cspdiag("fmt", ugly) == (0, "", f"formatted {ugly}\n")
    assert ugly.read_text() == pretty != UGLY
    assert cspdiag("fmt", ugly) == (0, "", "")
    assert cspdiag("fmt", "--check", ugly) == (0, "", "")
    assert cspdiag("fmt", "--diff", ugly) == (0, "", "")


def test_check_and_diff_change_nothing(cspdiag: Command, ugly: Path) -> None:
    assert cspdiag("fmt", "--check", ugly) == (1, "", f"would format {ugly}\n")
    result = cspdiag("fmt", "--diff", ugly)
    assert result.code == 1
    assert "-in given:int" in result.out
    assert ugly.read_text() == UGLY


def test_a_file_with_syntax_errors_stays_and_the_others_are_formatted(
    cspdiag: Command, ugly: Path, pretty: str
) -> None:
    broken = ugly.with_name("broken.csp")
    broken.write_text("process {")
    result = cspdiag("fmt", broken, ugly)
    assert result.code == 1
    assert "error[E01" in result.err
    assert broken.read_text() == "process {"
    assert ugly.read_text() == pretty


def test_a_meaningless_program_is_still_formatted(cspdiag: Command) -> None:
    result = cspdiag("fmt", "-", stdin="process A {composition{nobody}}")
    assert result.code == 0
    assert "nobody" in result.out


def test_standard_input_with_check_prints_nothing(cspdiag: Command) -> None:
    assert cspdiag("fmt", "--check", "-", stdin=UGLY) == (1, "", "would format -\n")


def test_a_difference_has_the_lines_of_the_file(cspdiag: Command, ugly: Path) -> None:
    ugly.write_text("// one two\f three\u2028 four\nconst  x = 1\n", newline="")
    difference = cspdiag("fmt", "--diff", ugly).out
    assert difference.count("No newline at end of file") == 0
    assert " // one two\f three\u2028 four\n-const  x = 1\n+const x = 1\n" in difference


def test_a_link_stays_a_link_and_its_target_is_formatted(cspdiag: Command, ugly: Path, pretty: str) -> None:
    link = ugly.with_name("link.csp")
    link.symlink_to(ugly)
    assert cspdiag("fmt", link).code == 0
    assert link.is_symlink()
    assert ugly.read_text() == pretty


def test_only_files_are_replaced(cspdiag: Command, tmp_path: Path) -> None:
    """A pipe would be read to its end, and then written to."""
    os.mkfifo(tmp_path / "pipe.csp")
    result = cspdiag("fmt", tmp_path / "pipe.csp")
    assert (result.code, result.err) == (
        2,
        f"cspdiag: {tmp_path / 'pipe.csp'}: is not a file that could be replaced; `fmt -` reads and prints\n",
    )


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_lines_end_as_the_first_one_did(cspdiag: Command, ugly: Path, pretty: str, end: str, mark: str) -> None:
    ugly.write_bytes((mark + UGLY.replace("\n", end)).encode())
    assert cspdiag("fmt", ugly).code == 0
    wanted = (mark + pretty.replace("\n", end)).encode()
    assert ugly.read_bytes() == wanted
    assert cspdiag("fmt", "--check", ugly) == (0, "", "")
    first, rest = wanted.split(end.encode(), 1)
    other = b"\n" if end == "\r\n" else b"\r\n"
    ugly.write_bytes(first + end.encode() + rest.replace(end.encode(), other))
    assert cspdiag("fmt", "--check", ugly) == (1, "", f"would format {ugly}\n")
    assert cspdiag("fmt", "--diff", ugly) == (1, "", f"would end all lines of {ugly} as its first one\n")
    assert cspdiag("fmt", ugly).code == 0
    assert ugly.read_bytes() == wanted
