"""``cspdiag diff``."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from cspdiag.draw.layout.elk import engine_available
from tests.cli.conftest import Command

LIBRARY = "submodel Law(gain: double<V>) { in e : double  out u : double<V>  u = gain * e }\n"
PROGRAM = """\
import "law.csp"

process Loop {
  in  e : double    @ 2 ms
  out u : double<V> @ 2 ms

  communication {
    law : Law(gain = 2<V>)

    e     -> law.e
    law.u -> u
  }

  composition {
    mu law
  }
}
"""


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A git repository with a program in a folder, and one commit."""
    folder = tmp_path / "the models"
    folder.mkdir()
    (folder / "law.csp").write_text(LIBRARY)
    (folder / "loop.csp").write_text(PROGRAM)
    git(tmp_path, "init", "--quiet", "--initial-branch=main")
    commit(tmp_path, "first")
    return folder


def git(folder: Path, *arguments: str) -> None:
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *identity, *arguments], cwd=folder, check=True, capture_output=True)


def commit(folder: Path, message: str) -> None:
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", message)


@pytest.fixture
def versions(tmp_path: Path) -> tuple[Path, Path]:
    """A program, and the same program with another period, in two files."""
    (tmp_path / "law.csp").write_text(LIBRARY)
    old, new = tmp_path / "old.csp", tmp_path / "new.csp"
    old.write_text(PROGRAM)
    new.write_text(PROGRAM.replace("@ 2 ms", "@ 5 ms"))
    return old, new


def test_equal_versions_have_no_differences(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    old, _ = versions
    assert cspdiag("diff", old, old) == (0, "", "")
    assert cspdiag("diff", old, old, "--format", "json") == (0, "[]\n", "")


def test_comments_and_layout_of_the_text_do_not_count(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    old, new = versions
    new.write_text("// a comment\n" + PROGRAM.replace("    mu law", "    // again and again\n    mu\n      law"))
    assert cspdiag("diff", old, new) == (0, "", "")
    new.write_text(PROGRAM.replace("gain = 2<V>", "gain=2<V>").replace("mu law", "mu (law ; (wait 1 ms))"))
    old.write_text(PROGRAM.replace("mu law", "mu (law;wait  1 ms)"))
    assert cspdiag("diff", old, new) == (0, "", "")


def test_differences_are_reported_by_definition_with_exit_code_1(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    result = cspdiag("diff", *versions)
    assert result == (1, "  process Loop\n    ~ port e: period 2 ms → 5 ms\n    ~ port u: period 2 ms → 5 ms\n", "")
    assert cspdiag("diff", *versions, "--exit-zero").code == 0


def test_differences_are_reported_to_machines(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    first, _ = json.loads(cspdiag("diff", *versions, "--format", "json").out)
    assert first == {
        "action": "changed",
        "kind": "process",
        "definition": "Loop",
        "subject": "port",
        "name": "e",
        "aspect": "period",
        "before": "2 ms",
        "after": "5 ms",
        "from": {"file": str(versions[0]), "line": 4, "column": 7},
        "to": {"file": str(versions[1]), "line": 4, "column": 7},
    }


def test_the_working_tree_is_compared_with_the_last_commit(cspdiag: Command, repository: Path) -> None:
    path = repository / "loop.csp"
    assert cspdiag("diff", path) == (0, "", "")
    path.write_text(PROGRAM.replace("2<V>", "3<V>"))
    assert cspdiag("diff", path).out == "  process Loop\n    ~ instance law: argument gain 2<V> → 3<V>\n"


def test_imports_are_those_of_the_revision(cspdiag: Command, repository: Path) -> None:
    (repository / "law.csp").unlink()
    (repository / "laws.csp").write_text(LIBRARY.replace("gain * e", "-gain * e"))
    path = repository / "loop.csp"
    path.write_text(PROGRAM.replace("law.csp", "laws.csp"))
    commit(repository, "second")
    reported = "  submodel Law\n    ~ equation u: value gain * e → -gain * e\n"
    assert cspdiag("diff", path, "--from", "HEAD~1").out == reported
    assert cspdiag("diff", path, "--from", "HEAD~1", "--to", "main").out == reported
    assert cspdiag("diff", path, "--from", "main") == (0, "", "")


def test_a_revision_precedes_a_file_as_in_git(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = repository / "loop.csp"
    path.write_text(PROGRAM.replace("2<V>", "3<V>"))
    monkeypatch.chdir(repository)
    reported = "  process Loop\n    ~ instance law: argument gain 2<V> → 3<V>\n"
    assert cspdiag("diff", "HEAD:the models/loop.csp", "loop.csp").out == reported
    assert cspdiag("diff", "HEAD:./loop.csp", "loop.csp").out == reported
    assert cspdiag("diff", "HEAD:./loop.csp").out == reported


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["loop.csp", "--from", "nowhere"], "no revision 'nowhere'"),
        (["HEAD:./other.csp", "loop.csp"], "other.csp: not in revision HEAD"),
        (["missing.csp", "loop.csp"], "missing.csp: no such file"),
        (["loop.csp", "loop.csp", "--to", "HEAD"], "--from and --to are for the revisions of one file"),
        (["HEAD:./loop.csp", "--from", "HEAD"], "names a revision, and so does --from"),
        (["loop.csp", "-o", "x.gif"], "must end in .svg, .png or .pdf"),
        (["loop.csp", "-o", "nowhere/x.svg"], "there is no folder nowhere"),
    ],
)
def test_versions_that_cannot_be_compared_are_refused_in_one_line(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], says: str
) -> None:
    monkeypatch.chdir(repository)
    result = cspdiag("diff", *arguments)
    assert (result.code, result.out) == (2, "")
    assert says in result.err
    assert result.err.count("\n") == 1


def test_outside_of_a_repository_two_files_are_needed(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    result = cspdiag("diff", versions[0])
    assert result.code == 2
    advice = "commit it first, or name two files to compare: diff OLD NEW"
    assert result.err == f"cspdiag: {versions[0]} is not in a git repository: {advice}\n"
    assert cspdiag("diff", *versions).code == 1


def test_before_the_first_commit_a_message_says_what_to_do(
    cspdiag: Command, repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    advice = "commit it first, or name two files to compare: diff OLD NEW"
    new = repository / "new.csp"
    new.write_text(PROGRAM)
    assert cspdiag("diff", new) == (2, "", f"cspdiag: {new}: not in revision HEAD ({advice})\n")
    fresh = tmp_path / "fresh"
    subprocess.run(["git", "init", "-q", str(fresh)], check=True)
    (fresh / "new.csp").write_text(PROGRAM)
    none = "there is no commit in this repository yet: commit the programs first, or name two files to compare"
    monkeypatch.chdir(fresh)
    for arguments in (["new.csp"], [], ["HEAD:new.csp"], ["HEAD:new.csp", "new.csp"]):
        assert cspdiag("diff", *arguments) == (2, "", f"cspdiag: {none}: diff OLD NEW\n")


def test_a_file_that_is_in_no_revision_and_a_revision_that_is_not_there(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    nowhere = "missing.csp: there is no such file, neither"
    assert cspdiag("diff", "missing.csp") == (2, "", f"cspdiag: {nowhere} here nor in revision HEAD\n")
    result = cspdiag("diff", "missing.csp", "--from", "main", "--to", "HEAD")
    assert result.err == f"cspdiag: {nowhere} in revision HEAD nor in revision main\n"
    unknown = (2, "", "cspdiag: there is no revision 'v9' in this repository\n")
    for arguments in (["--from", "v9"], ["--to", "v9"], ["loop.csp", "--to", "v9"], ["v9:./loop.csp"]):
        assert cspdiag("diff", *arguments) == unknown


def test_a_file_that_was_removed_added_or_renamed_is_compared_as_without_its_name(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also from another folder, and without what it imports."""
    (repository / "loop.csp").unlink()
    assert cspdiag("diff", repository / "loop.csp").out == "- process Loop\n"
    monkeypatch.chdir(repository)
    git(repository, "checkout", "-q", ".")
    git(repository, "mv", "loop.csp", "ring.csp")
    (repository / "ring.csp").write_text(PROGRAM.replace("2<V>", "3<V>"))
    changed = "  process Loop\n    ~ instance law: argument gain 2<V> → 3<V>\n"
    for name in ("ring.csp", "loop.csp"):
        assert cspdiag("diff", name).out == changed
    (repository / "ring.csp").write_text("enum Other { one }\n")
    git(repository, "add", "ring.csp")
    assert cspdiag("diff", "ring.csp") == (1, "+ enum Other\n", "")


def test_a_version_that_cannot_be_read_is_shown_with_its_errors(cspdiag: Command, versions: tuple[Path, Path]) -> None:
    old, new = versions
    new.write_text(PROGRAM.replace("communication {", "communication"))
    result = cspdiag("diff", old, new)
    assert (result.code, result.out) == (2, "  not compared: process Loop\n")
    assert "error[E01" in result.err
    assert "Traceback" not in result.err


def test_definitions_without_syntax_errors_are_compared_beside_those_with_errors(
    cspdiag: Command, tmp_path: Path
) -> None:
    old, new = tmp_path / "old.csp", tmp_path / "new.csp"
    old.write_text("const one = 1\n\nstruct Pose { x : double }\n\nenum Mode { idle, run }\n")
    new.write_text("const one = 2\n\nstruct Pose { x : }\n\nenum Mode { idle, run, halt }\n")
    for first, second, change in (
        (old, new, "    ~ value 1 → 2\n"),
        (new, old, "    ~ value 2 → 1\n"),
    ):
        result = cspdiag("diff", first, second)
        assert result.code == 2
        assert change in result.out
        assert "  not compared: struct Pose\n" in result.out
        assert "struct Pose\n" not in result.out.replace("not compared: struct Pose\n", "")
        assert result.err.count("error[") == 1


def test_all_changed_programs_of_a_folder_are_compared_as_a_comment(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    (repository / "loop.csp").write_text(PROGRAM.replace("2<V>", "3<V>"))
    (repository / "law.csp").rename(repository / "laws.csp")
    (repository / "broken.csp").write_text("process {\n")
    git(repository, "add", "--all")
    result = cspdiag("diff", "--format", "markdown")
    assert result.code == 2
    assert result.out.startswith("### `broken.csp`\n\nNot everything could be read:\n\n```text\nbroken.csp:1: E01")
    assert "### `laws.csp` (was `law.csp`)\n\nNothing changed in the diagrams.\n" in result.out
    assert "laws.csp (was law.csp)\n" in cspdiag("diff").out
    commit(repository, "second")
    (repository / "broken.csp").unlink()
    (repository / "laws.csp").unlink()
    (repository / "law.csp").write_text(LIBRARY)
    (repository / "loop.csp").write_text(PROGRAM.replace("2<V>", "4<V>"))
    git(repository, "add", "--all")
    text = cspdiag("diff", "--from", "HEAD~1")
    assert (text.code, text.out) == (1, "loop.csp\n  process Loop\n    ~ instance law: argument gain 2<V> → 4<V>\n")
    assert cspdiag("diff", "--from", "nowhere").code == 2


def test_definitions_that_moved_to_another_file_have_moved(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    other = LIBRARY.replace("Law", "Other")
    (repository / "law.csp").write_text(f"{LIBRARY}\n{other}")
    commit(repository, "second")
    (repository / "law.csp").write_text(LIBRARY)
    (repository / "others.csp").write_text(f"const n = 1\n\n{other}")
    git(repository, "add", "--all")
    moved = "  submodel Other\n    ~ file law.csp → others.csp\n"
    assert cspdiag("diff") == (1, f"others.csp\n  + const n\n{moved}".replace("  + const n", "+ const n = 1"), "")
    assert "! file law.csp → others.csp" in cspdiag("diff", "--format", "markdown").out
    (repository / "others.csp").write_text(other.replace("gain * e", "-gain * e"))
    assert cspdiag("diff").out == f"others.csp\n{moved}    ~ equation u: value gain * e → -gain * e\n"


def test_a_program_that_cannot_be_read_leaves_the_others_to_be_compared(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    (repository / "law.csp").write_bytes(b"\xff")
    (repository / "loop.csp").write_text(PROGRAM.replace("2<V>", "3<V>"))
    text = cspdiag("diff")
    assert (text.code, text.err) == (2, "cspdiag: law.csp: not UTF-8 text (byte 0xff at offset 0)\n")
    assert "instance law: argument gain 2<V> → 3<V>" in text.out
    comment = cspdiag("diff", "--format", "markdown", "--exit-zero")
    assert comment.code == 2
    assert "### `law.csp`\n\nNot everything could be read:\n\n```text\nlaw.csp: not UTF-8 text" in comment.out


def test_without_a_repository_the_programs_of_a_folder_cannot_be_compared(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    advice = "this folder is not in a git repository: name two files to compare: diff OLD NEW"
    assert cspdiag("diff") == (2, "", f"cspdiag: {advice}\n")


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_changed_programs_are_drawn_into_a_folder(
    cspdiag: Command, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    (repository / "loop.csp").write_text(PROGRAM.replace("2<V>", "3<V>"))
    result = cspdiag("diff", "--format", "markdown", "-o", "the changes/")
    assert result.code == 1
    assert "![What changed in the diagrams of loop.csp](the%20changes/loop.svg)" in result.out
    assert (repository / "the changes" / "loop.svg").read_text().startswith("<svg")
    refused = cspdiag("diff", "-o", "changes.svg")
    assert (refused.code, refused.out) == (2, "")
    assert "need a folder" in refused.err


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_the_changed_diagrams_are_drawn(cspdiag: Command, versions: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "changes.svg"
    result = cspdiag("diff", *versions, "-o", out)
    assert (result.code, result.err) == (1, f"wrote {out}\n")
    assert out.read_text().count('class="badge changed"') == 4
