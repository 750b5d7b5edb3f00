"""``cspdiag check --fix`` and ``--diff``: which files change, how, and what is reported."""

from __future__ import annotations

import json
import os
import secrets
from pathlib import Path

import pytest

from cspdiag.cli.support.checking import fixing
from tests.cli.conftest import BAD, GOOD, Command

SLIP = GOOD.replace("given ? held", "given ? hedl")
"""A program with one mistake, which has a fix."""


@pytest.fixture
def slip(tmp_path: Path) -> Path:
    path = tmp_path / "my slips" / "slip.csp"
    path.parent.mkdir()
    path.write_text(SLIP)
    return path


def test_certain_corrections_are_written(cspdiag: Command, slip: Path) -> None:
    slip.chmod(0o640)
    assert cspdiag("check", "--fix", slip) == (0, "", f"fixed 1 in {slip}\nchecked 1 file: no errors\n")
    assert slip.read_text() == GOOD
    assert slip.stat().st_mode & 0o777 == 0o640
    assert [path.name for path in slip.parent.iterdir()] == [slip.name]
    assert cspdiag("check", "--fix", slip) == (0, "", "checked 1 file: no errors\n")


def test_what_is_left_is_shown_and_decides_the_exit_code(cspdiag: Command, slip: Path) -> None:
    slip.write_text(BAD.replace("given ? held", "given ? hedl"))
    result = cspdiag("check", "--fix", slip)
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith(f"fixed 1 in {slip}\nerror[E0204]")
    assert result.err.endswith("\n1 error\n")
    assert slip.read_text() == BAD


def test_a_file_without_fixes_is_not_written(cspdiag: Command, bad: Path, good: Path) -> None:
    bad.write_bytes(BAD.replace("\n", "\r\n").encode())
    before = [(path.read_bytes(), path.stat().st_ino) for path in (bad, good)]
    assert cspdiag("check", "--fix", bad, good) == cspdiag("check", bad, good)
    assert [(path.read_bytes(), path.stat().st_ino) for path in (bad, good)] == before


def test_the_difference_is_printed_and_nothing_written(cspdiag: Command, slip: Path) -> None:
    result = cspdiag("check", "--diff", slip)
    assert (result.code, result.err) == (1, f"would fix 1 in {slip}\n")
    assert result.out.splitlines()[:2] == [f"--- {slip}", f"+++ {slip} (fixed)"]
    assert "-    mu (given ? hedl ; taken ! held)\n+    mu (given ? held ; taken ! held)\n" in result.out
    assert slip.read_text() == SLIP
    assert cspdiag("check", "--fix", "--diff", slip) == result


def test_without_fixes_there_is_no_difference(cspdiag: Command, good: Path, bad: Path) -> None:
    assert cspdiag("check", "--diff", good) == (0, "", "")
    assert cspdiag("check", "--diff", bad) == (1, "", "1 error is left that only you can fix\n")


def test_imported_files_are_fixed_too_and_the_library_is_not(cspdiag: Command, slip: Path) -> None:
    main = slip.with_name("main.csp")
    slip.write_text(SLIP.replace("Relay", "Hands"))
    main.write_text(
        f'import "{slip.name}"\nimport std.control\n\nprocess Main {{\n  in  a : int\n  out b : int\n\n'
        "  communication {\n    relay : Hands\n    a           -> relay.given\n    relay.taekn -> b\n  }\n\n"
        "  composition {\n    relay\n  }\n}\n"
    )
    result = cspdiag("check", "--fix", main)
    assert result.code == 0
    assert set(result.err.splitlines()[:2]) == {f"fixed 1 in {main}", f"fixed 1 in {slip}"}
    assert slip.read_text() == GOOD.replace("Relay", "Hands")
    assert "relay.taken -> b" in main.read_text()


def test_a_file_with_two_names_is_fixed_once(cspdiag: Command, slip: Path) -> None:
    link = slip.with_name("link.csp")
    link.symlink_to(slip.name)
    result = cspdiag("check", "--fix", slip, link)
    assert (result.code, result.err.splitlines()[0]) == (0, f"fixed 1 in {slip}")
    assert (slip.read_text(), link.is_symlink()) == (GOOD, True)


def test_standard_input_is_printed_fixed(cspdiag: Command) -> None:
    assert cspdiag("check", "--fix", "-", stdin=SLIP) == (
        0,
        GOOD,
        "fixed 1 in standard input\nchecked 1 file: no errors\n",
    )
    assert cspdiag("check", "--fix", "-", stdin=GOOD).out == GOOD
    assert cspdiag("check", "--diff", "-", stdin=SLIP).out.startswith("--- -\n+++ - (fixed)\n")


@pytest.mark.parametrize("arguments", [("--fix", "-"), ("--diff", "a.csp")])
def test_two_texts_do_not_share_standard_output(cspdiag: Command, arguments: tuple[str, ...]) -> None:
    result = cspdiag("check", "--format", "json", *arguments, stdin=SLIP)
    assert (result.code, result.out) == (2, "")
    assert "where --format json writes, too" in result.err


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_ends_of_lines_and_the_byte_order_mark_stay(cspdiag: Command, slip: Path, mark: bytes) -> None:
    for end in (b"\n", b"\r\n", b"\r"):
        slip.write_bytes(mark + SLIP.encode().replace(b"\n", end))
        assert cspdiag("check", "--fix", slip).code == 0
        assert slip.read_bytes() == mark + GOOD.encode().replace(b"\n", end)


def test_each_line_keeps_its_own_line_end(cspdiag: Command, slip: Path) -> None:
    head, _, rest = SLIP.partition("\n")
    slip.write_bytes(f"{head}\r\n{rest}".encode())
    assert cspdiag("check", "--fix", slip).code == 0
    lines = GOOD.split("\n")
    changed = next(at for at, line in enumerate(lines) if "given ? held" in line)
    ends = ["\r\n" if at in (0, changed) else "\n" for at in range(len(lines) - 1)]
    assert slip.read_bytes().decode() == "".join(map(str.__add__, lines, ends))


def test_an_added_last_line_end_is_that_of_the_file(cspdiag: Command, slip: Path) -> None:
    slip.write_bytes(SLIP.rstrip().replace("\n", "\r").encode())
    assert cspdiag("check", "--fix", slip).code == 0
    assert slip.read_bytes().decode().rstrip() == GOOD.rstrip().replace("\n", "\r")


def test_a_read_only_file_is_left_alone_and_so_are_the_others(cspdiag: Command, slip: Path) -> None:
    other = slip.with_name("other.csp")
    other.write_text(SLIP)
    slip.chmod(0o444)
    result = cspdiag("check", "--fix", other, slip)
    assert result.code == 2
    assert "it is read-only" in result.err
    assert "nothing was written" in result.err
    assert (slip.read_text(), other.read_text()) == (SLIP, SLIP)
    assert cspdiag("check", "--diff", slip).code == 1


def test_a_file_changed_meanwhile_is_not_overwritten(
    cspdiag: Command, slip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fix_slowly(*arguments: object) -> object:
        result = original(*arguments)
        slip.write_text(GOOD + "// another's\n")
        return result

    original = fixing.fix
    monkeypatch.setattr(fixing, "fix", fix_slowly)
    result = cspdiag("check", "--fix", slip)
    assert result.code == 2
    assert "was changed by another program meanwhile" in result.err
    assert slip.read_text() == GOOD + "// another's\n"


@pytest.mark.parametrize("problem", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_all_files_are_written_or_none(
    cspdiag: Command, slip: Path, monkeypatch: pytest.MonkeyPatch, problem: BaseException
) -> None:
    other = slip.with_name("other.csp")
    other.write_text(SLIP)

    names = iter(["first", None])

    def temporary_name(length: int) -> str:
        name = next(names)
        if name is None:
            raise problem
        return name

    monkeypatch.setattr(secrets, "token_hex", temporary_name)
    result = cspdiag("check", "--fix", slip, other)
    assert result.code != 0
    assert f"{other}: no space" in result.err or isinstance(problem, KeyboardInterrupt)
    assert (slip.read_text(), other.read_text()) == (SLIP, SLIP)
    assert {path.name for path in slip.parent.iterdir()} == {slip.name, other.name}


def test_only_files_are_replaced_by_output(cspdiag: Command, tmp_path: Path) -> None:
    read, write = os.pipe()
    os.write(write, SLIP.encode())
    os.close(write)
    try:
        result = cspdiag("check", "--fix", f"/dev/fd/{read}")
    finally:
        os.close(read)
    assert result.code == 2
    assert "not a file that could be replaced" in result.err


def test_a_file_that_cannot_be_read_does_not_keep_others_from_being_fixed(cspdiag: Command, slip: Path) -> None:
    result = cspdiag("check", "--fix", slip.with_name("missing.csp"), slip)
    assert result.code == 2
    assert "missing.csp: no such file" in result.err
    assert slip.read_text() == GOOD


def test_machines_are_given_the_edits(cspdiag: Command, slip: Path, bad: Path) -> None:
    (found,) = json.loads(cspdiag("check", "--format", "json", slip).out)
    place = {"file": str(slip), "line": 11, "column": 17, "end_line": 11, "end_column": 21}
    assert found["edits"] == [{**place, "replacement": "held"}]
    (found,) = json.loads(cspdiag("check", "--format", "json", bad).out)
    assert found["edits"] == []
    (run,) = json.loads(cspdiag("check", "--format", "sarif", slip).out)["runs"]
    (fix,) = run["results"][0]["fixes"]
    (change,) = fix["artifactChanges"]
    assert fix["description"]["text"] == "did you mean `held`?"
    place = run["results"][0]["locations"][0]["physicalLocation"]
    assert change["artifactLocation"] == place["artifactLocation"]
    assert change["replacements"] == [{"deletedRegion": place["region"], "insertedContent": {"text": "held"}}]


def test_fixed_diagnostics_are_not_reported_to_machines(cspdiag: Command, slip: Path) -> None:
    result = cspdiag("check", "--fix", "--format", "json", slip)
    assert (result.code, json.loads(result.out), result.err) == (0, [], f"fixed 1 in {slip}\n")


def test_check_without_fix_mentions_fixes(cspdiag: Command, slip: Path, bad: Path) -> None:
    assert cspdiag("check", slip).err.endswith("\n1 error\n--fix corrects it, --diff shows how\n")
    assert cspdiag("check", slip, bad).err.endswith("\n2 errors\n--fix corrects 1 of them, --diff shows how\n")
    assert "--fix" not in cspdiag("check", bad).err
    assert "--fix" not in cspdiag("check", "--format", "concise", slip).err
