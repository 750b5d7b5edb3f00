"""A server answers what the command would have answered, byte for byte."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag.cli.support.diagnostic_formats import FORMATS
from tests.cli.conftest import BAD, GOOD
from tests.cli.server.commands import Place
from tests.literate import all_cases

MISSPELT = GOOD.replace("process", "proces")


@pytest.fixture
def programs(place: Place) -> Path:
    for name, text in (("good", GOOD), ("bad", BAD), ("misspelt", MISSPELT)):
        (place.programs / f"{name}.csp").write_text(text)
    (place.programs / "user.csp").write_text('import "bad.csp"\nimport "missing.csp"\n')
    (place.programs / "binary.csp").write_bytes(b"\xff\xfe\x00")
    (place.programs / "folder.csp").mkdir()
    return place.programs


def test_programs_of_the_literate_cases(place: Place) -> None:
    names = []
    for number, case in enumerate(all_cases()):
        folder = place.programs / f"case{number}"
        folder.mkdir()
        for file, text in case.files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_text(text)
            names.append(f"case{number}/{file}")
    assert len(names) > 300
    alone, served = place.both(*names)
    assert served == alone
    assert len(alone.err) > 100_000


def test_all_formats_before_and_after_the_server_has_learned(place: Place, programs: Path) -> None:
    names = ("good.csp", "user.csp", "misspelt.csp", "bad.csp")
    for format_ in (*FORMATS, "text"):
        alone, served = place.both("--format", format_, *names)
        assert served == alone
        assert alone.code == 1


COMMAND_LINES = [
    ["good.csp"],
    ["nothing.csp", "bad.csp", "binary.csp", "folder.csp"],
    ["--color", "always", "bad.csp"],
    ["--color", "purple", "bad.csp"],
    ["--format", "text"],
    ["--formt", "text", "good.csp"],
    ["--help"],
    ["--diff", "misspelt.csp"],
    ["caf\udce9\n.csp"],
    ["--", "--server"],
]


def test_all_ways_to_end(place: Place, programs: Path) -> None:
    for arguments in COMMAND_LINES:
        alone, served = place.both(*arguments)
        assert served == alone, arguments


def test_standard_input(place: Place) -> None:
    for text in (GOOD, BAD, "process \N{GREEK SMALL LETTER PI} {"):
        alone, served = place.both("-", stdin=text.encode())
        assert served == alone, text


def test_fixes_have_the_permissions_and_the_folder_of_the_command(place: Place, programs: Path) -> None:
    (programs / "below").mkdir()
    below = programs / "below" / "misspelt.csp"
    below.write_text(MISSPELT)
    below.chmod(0o640)
    answer = place.check("--server", "--fix", "misspelt.csp", cwd=programs / "below")
    assert answer.code == 0, answer.err
    assert below.read_text() == GOOD
    assert below.stat().st_mode & 0o777 == 0o640
    assert (programs / "misspelt.csp").read_text() == MISSPELT


def test_the_environment_is_that_of_the_command(place: Place, programs: Path) -> None:
    narrow = {**place.environment, "COLUMNS": "50"}
    alone, served = place.both("--help", env=narrow)
    assert served == alone
    assert served != place.check("--server", "--help")


def test_streams_that_are_closed_or_full(place: Place, programs: Path) -> None:
    def run(redirection: str, *options: str) -> tuple[int, bytes, bytes]:
        # The exit code comes by another way than the streams.
        shell = 'exec 3>&1; { "$0" -m cspdiag check "$@"; echo $? >&3; } ' + redirection
        command = ["sh", "-c", shell, sys.executable, *options, "--format", "json", "bad.csp"]
        done = subprocess.run(
            command, cwd=programs, env=place.environment, capture_output=True, timeout=60, check=False
        )
        return done.returncode, done.stdout, done.stderr

    for redirection in (">&-", "2>&-", ">/dev/full", "2>/dev/full", "| true", "<&-"):
        assert run(redirection, "--server") == run(redirection), redirection


def test_a_terminal(place: Place, programs: Path) -> None:
    def shown(*options: str) -> bytes:
        ours, theirs = pty.openpty()
        answer = place.start(*options, "bad.csp", stdin=theirs, stderr=theirs)
        os.close(theirs)
        text = b""
        try:
            while part := os.read(ours, 4096):
                text += part
        except OSError:
            pass
        os.close(ours)
        answer.communicate(timeout=60)
        assert answer.returncode == 1
        return text

    plain = {**place.environment}
    for name in ("NO_COLOR", "TERM"):
        plain.pop(name, None)
    place.environment = {**plain, "TERM": "xterm"}
    before = place.count()
    assert b"\x1b[" in shown("--server")
    assert shown("--server") == shown()
    assert place.count() == before + 2


def test_what_has_changed_is_checked_again(place: Place, programs: Path) -> None:
    (programs / "user.csp").write_text('import "bad.csp"\n')
    for _ in range(3):
        assert place.both("user.csp")[1].code == 1
    facts = (programs / "bad.csp").stat()
    # The size and the time stay the same: only the content decides.
    (programs / "bad.csp").write_text(BAD.replace("hold)", "held)"))
    os.utime(programs / "bad.csp", ns=(facts.st_atime_ns, facts.st_mtime_ns))
    alone, served = place.both("user.csp")
    assert served == alone
    assert alone.code == 0
    (programs / "bad.csp").unlink()
    alone, served = place.both("user.csp")
    assert served == alone
    assert alone.code == 1


def test_the_same_names_in_other_folders_are_other_programs(place: Place, programs: Path) -> None:
    (programs / "other").mkdir()
    (programs / "other" / "bad.csp").write_text(GOOD)
    (programs / "user.csp").write_text('import "bad.csp"\n')
    (programs / "other" / "user.csp").write_text('import "bad.csp"\n')
    for _ in range(2):
        assert place.both("user.csp")[1].code == 1
        assert place.both("user.csp", cwd=programs / "other")[1].code == 0
