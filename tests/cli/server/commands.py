"""Commands in processes of their own, with servers that no other test sees."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[3]


class Answer(NamedTuple):
    code: int
    out: bytes
    err: bytes


class Place:
    """A folder for programs, and one for servers."""

    def __init__(self, folder: Path, package: Path = ROOT) -> None:
        self.programs = folder / "programs"
        self.sockets = folder / "sockets"
        for made in (self.programs, self.sockets):
            made.mkdir(mode=0o700)
        self.environment = {**os.environ, "XDG_RUNTIME_DIR": str(self.sockets), "PYTHONPATH": str(package)}
        self.environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def start(self, *arguments: str | Path, **options: object) -> subprocess.Popen[bytes]:
        streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        given = {"cwd": self.programs, "env": self.environment, **streams, **options}
        command = [sys.executable, "-m", "cspdiag", "check", *map(str, arguments)]
        return subprocess.Popen(command, **given)  # type: ignore[call-overload,no-any-return]

    def check(self, *arguments: str | Path, stdin: bytes = b"", **options: object) -> Answer:
        process = self.start(*arguments, **options)
        out, err = process.communicate(stdin, timeout=60)
        return Answer(process.returncode, out, err)

    def both(self, *arguments: str | Path, stdin: bytes = b"", **options: object) -> tuple[Answer, Answer]:
        """The answers of a process by itself, and of the server, which must have answered."""
        alone = self.check(*arguments, stdin=stdin, **options)
        before = self.count()
        served = self.check("--server", *arguments, stdin=stdin, **options)
        assert self.count() == before + 1, "the server did not answer"
        return alone, served

    def status(self) -> str:
        return self.check("--server-status").out.decode()

    def server(self) -> int:
        """The process of the only server."""
        (process,) = re.findall(r"^server (\d+):", self.status(), re.MULTILINE)
        return int(process)

    def count(self) -> int:
        """How many commands the server has carried out. It notices a little later than the command."""
        time.sleep(0.05)
        (count,) = re.findall(r", (\d+) commands?$", self.status(), re.MULTILINE)
        return int(count)

    def wait_for_server(self) -> None:
        deadline = time.monotonic() + 60
        while self.check("--server-status").code:
            assert time.monotonic() < deadline, "no server has started"
            time.sleep(0.05)

    def is_empty(self) -> bool:
        return not list(self.sockets.iterdir())


@contextmanager
def served(place: Place) -> Iterator[Place]:
    """A place with a server."""
    try:
        place.check("--server", "nothing.csp")
        place.wait_for_server()
        yield place
    finally:
        place.check("--server-stop")
