"""Anything that is not a regular file is refused wherever a file is read: a pipe may never have a writer."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from cspdiag.base.sources import read_source

PROGRAM = "process Main {\n  composition { skip }\n}\n"
PATIENCE = 60
"""After this many seconds, a command has been waiting for a writer."""


def cspdiag(folder: Path, *arguments: str, text: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "cspdiag", *arguments]
    given = {"stdin": subprocess.DEVNULL} if text is None else {"input": text}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False, **given)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    os.mkfifo(tmp_path / "pipe.csp")
    (tmp_path / "main.csp").write_text(PROGRAM)
    (tmp_path / "importer.csp").write_text(f'import "pipe.csp"\n\n{PROGRAM}')
    (tmp_path / "link.csp").symlink_to("pipe.csp")
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", "pipe.csp"),
        ("check", "link.csp"),
        ("check", "main.csp", "pipe.csp"),
        ("run", "pipe.csp"),
        ("compile", "--emit", "ast", "pipe.csp"),
        ("draw", "pipe.csp"),
        ("fmt", "--check", "pipe.csp"),
        ("diff", "main.csp", "pipe.csp"),
        ("verify", "pipe.csp"),
        ("verify", "--timing", "--wcet-from", "pipe.csp", "main.csp"),
        ("run", "--replay", "pipe.csp", "main.csp"),
    ],
    ids=" ".join,
)
def test_a_named_pipe_on_the_command_line_is_refused(folder: Path, arguments: tuple[str, ...]) -> None:
    result = cspdiag(folder, *arguments)
    assert (result.returncode, result.stdout) == (2, "")
    named = "link.csp" if "link.csp" in arguments else "pipe.csp"
    assert result.stderr.splitlines()[-1] == f"cspdiag: {named}: it is a named pipe, not a file"


@pytest.mark.parametrize("options", [("check", "main.csp"), ("verify",), ("verify", "--timing")], ids=" ".join)
@pytest.mark.parametrize("format_", ["json", "sarif", "github", "junit"])
def test_a_program_that_cannot_be_read_is_in_reports(folder: Path, options: tuple[str, ...], format_: str) -> None:
    (folder / "latin.csp").write_bytes("// Régulateur\n".encode("latin-1"))
    result = cspdiag(folder, *options, "latin.csp", "--format", format_)
    assert result.returncode == 2
    reason = "not UTF-8 text (byte 0xe9 at offset 4)"
    assert result.stderr == f"cspdiag: latin.csp: {reason}\n"
    assert f"cannot read this file: {reason}" in result.stdout
    assert "E0120" in result.stdout
    if format_ == "junit":
        suites = {suite.get("name"): suite.get("failures") for suite in ElementTree.fromstring(result.stdout)}
        assert suites == ({"main.csp": "0"} if "main.csp" in options else {}) | {"latin.csp": "1"}


def test_a_missing_program_is_in_the_json_of_proofs(folder: Path) -> None:
    result = cspdiag(folder, "verify", "missing.csp", "--json", "proofs.json")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.splitlines()[-1] == "cspdiag: missing.csp: no such file or directory"
    (found,) = json.loads((folder / "proofs.json").read_text())
    assert (found["code"], found["file"]) == ("E0120", "missing.csp")
    assert found["message"] == "cannot read this file: no such file or directory"


def test_an_import_of_a_named_pipe_is_refused_at_its_place(folder: Path) -> None:
    result = cspdiag(folder, "check", "--format", "json", "importer.csp")
    found = json.loads(result.stdout)
    assert result.returncode == 1
    assert [(each["code"], each["message"]) for each in found] == [
        ("E0120", 'cannot import "pipe.csp": it is a named pipe, not a file')
    ]


def test_an_external_body_that_is_a_named_pipe_is_refused(folder: Path) -> None:
    os.mkfifo(folder / "stick.py")
    (folder / "main.csp").write_text(
        'driver Stick python "stick.py:Stick" {\n  out x : int\n}\n'
        "process Main {\n  in x : int\n  communication { var v : int }\n  composition { x ? v }\n}\n"
        "environment Bench for Main {\n  stick : Stick\n  stick.x -> x\n}\n"
    )
    result = cspdiag(folder, "run", "main.csp")
    assert result.returncode == 2
    assert "stick.py: it is a named pipe, not a file" in result.stderr


def test_sockets_and_devices_are_no_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind("socket.csp")
        with pytest.raises(OSError, match="it is a socket, not a file"):
            read_source("socket.csp")
    with pytest.raises(OSError, match="it is a device, not a file"):
        read_source("/dev/zero")


@pytest.mark.parametrize("name", ["-", "/dev/stdin", "/dev/fd/0"])
def test_standard_input_is_read_from_a_pipe(tmp_path: Path, name: str) -> None:
    result = cspdiag(tmp_path, "check", name, text=PROGRAM)
    assert (result.returncode, result.stderr) == (0, "checked 1 file: no errors\n")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_each_end_of_a_line_ends_a_comment_and_a_line(tmp_path: Path, end: str) -> None:
    lines = ["// A controller.", "process Main {", "  /* two", "     lines */", "  composition { skipp }", "}", ""]
    (tmp_path / "main.csp").write_bytes(end.join(lines).encode())
    result = cspdiag(tmp_path, "check", "--format", "concise", "main.csp")
    assert result.returncode == 1
    assert result.stderr.startswith("main.csp:5:17: error[E0204]")
    assert cspdiag(tmp_path, "fmt", "main.csp").returncode == 0
    formatted = (tmp_path / "main.csp").read_bytes().decode()
    assert formatted.splitlines()[:2] == ["// A controller.", "process Main {"]
    assert f"/* two{end}     lines */{end}" in formatted
