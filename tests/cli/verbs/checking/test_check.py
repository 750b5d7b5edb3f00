from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.cli.conftest import BAD, GOOD, Command


def test_a_clean_program(cspdiag: Command, good: Path) -> None:
    assert cspdiag("check", good) == (0, "", "checked 1 file: no errors\n")
    assert cspdiag("check", "-", stdin=GOOD) == (0, "", "checked 1 file: no errors\n")


def test_an_error_is_shown_with_its_source_on_standard_error(cspdiag: Command, bad: Path) -> None:
    result = cspdiag("check", bad)
    assert (result.code, result.out) == (1, "")
    assert f"--> {bad}:11:32" in result.err
    assert "11 |     mu (given ? held ; taken ! hold)" in result.err
    assert result.err.endswith("\n1 error\n")


def test_several_files_are_checked_each_and_reported_once(cspdiag: Command, good: Path, bad: Path) -> None:
    result = cspdiag("check", good, bad, bad)
    assert result.code == 1
    assert result.err.endswith("\n1 error\n")
    assert cspdiag("check", good, good.rename(good.with_name("b.csp")), bad).code == 2


def test_a_file_that_cannot_be_read_does_not_keep_the_others_from_being_checked(
    cspdiag: Command, good: Path, bad: Path
) -> None:
    missing = [good.with_name(name) for name in ("nothing.csp", "nowhere.csp")]
    result = cspdiag("check", missing[0], bad, missing[1])
    assert result.code == 2
    assert f"--> {bad}:11:32" in result.err
    assert result.err.splitlines()[-1].startswith(f"cspdiag: {missing[0]}: no such file")
    assert str(missing[1]) in result.err.splitlines()[-1]
    assert cspdiag("check", missing[0]).err.count("\n") == 1


def test_an_import_that_several_files_share_is_reported_once(cspdiag: Command, good: Path, bad: Path) -> None:
    users = [good.with_name(f"user{number}.csp") for number in range(2)]
    for user in users:
        user.write_text(f'import "{bad.name}"\n')
    result = cspdiag("check", "--format", "json", *users)
    assert result.code == 1
    assert len(json.loads(result.out)) == 1


def test_standard_input_is_named_by_its_sign(cspdiag: Command) -> None:
    assert cspdiag("check", "--format", "concise", "-", stdin=BAD).err.startswith("-:11:32: error[E")


def test_formats_for_machines_go_to_standard_output(cspdiag: Command, good: Path, bad: Path) -> None:
    found = cspdiag("check", "--format", "json", bad)
    assert (found.code, found.err) == (1, "")
    (entry,) = json.loads(found.out)
    assert (entry["file"], entry["line"], entry["column"]) == (str(bad), 11, 32)
    assert cspdiag("check", "--format", "json", good) == (0, "[]\n", "")
    assert json.loads(cspdiag("check", "--format", "sarif", bad).out)["runs"][0]["results"][0]["level"] == "error"
    assert cspdiag("check", "--format", "github", bad).out.startswith("::error file=")
    suites = ElementTree.fromstring(cspdiag("check", "--format", "junit", good, bad).out)
    assert [suite.get("failures") for suite in suites] == ["0", "1"]


def test_colours(cspdiag: Command, bad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "\x1b" not in cspdiag("check", bad).err
    assert "\x1b[1;31m" in cspdiag("check", "--color", "always", bad).err
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b" in cspdiag("check", bad).err
    assert "\x1b" not in cspdiag("check", "--color", "never", bad).err
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in cspdiag("check", bad).err


def test_single_precision_is_checked_where_it_is_asked_for(tmp_path: Path, cspdiag: Command) -> None:
    program = tmp_path / "large.csp"
    program.write_text("process Main {\n  out y : double @ 1 ms\n\n  composition { y ! 1e100 ; y ! 0 }\n}\n")
    assert cspdiag("check", program).code == 0
    result = cspdiag("check", "--real", "float32", program)
    assert result.code == 1
    assert "error[E0908]: 1e+100 is too large for single precision" in result.err
    assert "invalid choice: 'half'" in cspdiag("check", "--real", "half", program).err


@pytest.mark.parametrize("format_", ["text", "concise", "json", "sarif", "github", "junit"])
def test_names_that_are_too_long_to_read_are_shortened(cspdiag: Command, tmp_path: Path, format_: str) -> None:
    path = tmp_path / "long.csp"
    path.write_text(f"const {'n' * 5000} = 1\nconst {'n' * 5000} = {'m' * 5000}\n")
    result = cspdiag("check", "--format", format_, path)
    assert result.code == 1
    assert f"`{'n' * 40}…{'n' * 39}`" in (result.out + result.err).replace("\\u2026", "…")
    assert len(result.out + result.err) < 6000
