from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from cspdiag.cli.main import main


class Result(NamedTuple):
    """The result of a command: exit code, standard output, standard error."""

    code: int
    out: str
    err: str


Command = Callable[..., Result]


@pytest.fixture
def cspdiag(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Command:
    """Run a command line within this process."""

    def command(*arguments: str | Path, stdin: str | bytes | None = None) -> Result:
        if stdin is not None:
            data = stdin.encode() if isinstance(stdin, str) else stdin
            monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Result(code, captured.out, captured.err)

    return command


GOOD = """\
/// Hands on what it is given.
process Relay {
  in  given : int
  out taken : int

  communication {
    var held : int = 0
  }

  composition {
    mu (given ? held ; taken ! held)
  }
}
"""

BAD = GOOD.replace("taken ! held", "taken ! hold")


@pytest.fixture
def good(tmp_path: Path) -> Path:
    """A program without errors, in a folder whose name has a space."""
    folder = tmp_path / "my models"
    folder.mkdir()
    path = folder / "relay.csp"
    path.write_text(GOOD)
    return path


@pytest.fixture
def bad(good: Path) -> Path:
    """The same with one error, in line 11."""
    path = good.with_name("bad.csp")
    path.write_text(BAD)
    return path
