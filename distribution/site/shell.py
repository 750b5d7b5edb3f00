"""Runs the commands of a page in a folder of its own, and keeps what they print and the files that they write."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
_LIMIT = 300
"""Seconds that the commands of a block may take."""

_TIMES = (
    (re.compile(r"^([A-Z]+ +\S.*), [\d.e-]+ s\)$", re.MULTILINE), r"\1)"),
    (re.compile(r"^(\d+ (?:propert|assertion).*) in [\d.e-]+ s$", re.MULTILINE), r"\1"),
    (re.compile(r"^(\d+ runs) in [\d.]+ s(?: after [\d.]+ s of compiling)?", re.MULTILINE), r"\1"),
    (re.compile(r"^(  simulated [\d.]+ \w+) in .*$", re.MULTILINE), r"\1"),
)
"""What is left out of what commands print: how long it took on the machine that made the site."""


class CommandError(Exception):
    """A command of a page failed; the message says which and how."""


class Shell:
    """A folder that looks like the top of the repository, and ``sh`` in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        shutil.copytree(ROOT / "models", folder / "models", ignore=shutil.ignore_patterns("__pycache__"))

    def write(self, name: str, text: str) -> None:
        """Save a program of the page."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run(self, commands: str) -> str:
        """What the commands print, in order, without how long they took.

        Exit code 1 is an answer, as of ``verify`` about what does not hold.

        Raises CommandError for any other, and for a traceback.
        """
        printed = []
        for command in commands.replace("\\\n", "").splitlines():
            if not command.strip() or command.startswith("#"):
                continue
            code, output = self.execute(command)
            if code not in (0, 1) or "Traceback (most recent" in output:
                raise CommandError(f"`{command}` ended with exit code {code}:\n{output}")
            printed.append(output)
        return without_times("".join(printed))

    def execute(self, command: str) -> tuple[int, str]:
        """The exit code of a command, and what it prints."""
        environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
        environment |= {"COLUMNS": "100", "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            ["sh", "-c", command],
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=_LIMIT,
            check=False,
        )
        return done.returncode, done.stdout

    @property
    def pictures(self) -> set[str]:
        """The pictures that commands have written so far."""
        return {path.name for path in self.folder.glob("*.svg")}

    def __contains__(self, name: str) -> bool:
        return (self.folder / name).is_file()


def without_times(printed: str) -> str:
    """What a command printed without the times that it took, which say nothing to those who read the site."""
    for pattern, kept in _TIMES:
        printed = pattern.sub(kept, printed)
    return printed
