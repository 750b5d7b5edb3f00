"""The changes of parameters that a run is given by ``--tune``: from a file, or while it runs from standard input."""

from __future__ import annotations

import sys
import threading
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from cspdiag.cli.support.failure import UsageError, described
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.live import RunningProgram
    from cspdiag.model.program import Program
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.kernel.parameters import Change


class Tuning:
    """The changes that are known before the run, and those that are read while it continues."""

    def __init__(self, program: Program, source: str, *, live: bool) -> None:
        self.program = program
        self.source = source
        self.live = live
        self.changes: tuple[Change, ...] = ()
        if not live:
            self.changes = tuple(self._parsed(enumerate(_lines(source), start=1), lambda: 0))

    def _parsed(self, lines: Iterable[tuple[int, str]], now: Callable[[], int]) -> Iterator[Change]:
        """The changes in lines; a wrong line is reported, and left out."""
        from cspdiag.settings import SettingError
        from cspdiag.tuning import parse_line

        for number, line in lines:
            try:
                change = parse_line(self.program, line, now())
            except SettingError as problem:
                say(f"cspdiag: --tune, line {number}: {problem}")
            else:
                if change is not None:
                    yield change

    def attach(self, running: RunningProgram) -> None:
        """Read changes while the program runs; each is made at the next instant, unless it names a later one."""
        if not self.live:
            return

        def work() -> None:
            for change in self._parsed(enumerate(sys.stdin, start=1), lambda: running.now):
                running.parameters.plan([change])

        threading.Thread(target=work, name="tuning", daemon=True).start()


def tuning_of(arguments: Namespace, program: Program, network: CoreNetwork) -> Tuning | None:
    """What ``--tune`` asks for. Raises UsageError."""
    source: str | None = arguments.tune
    if source is None:
        return None
    if not network.parameters:
        raise UsageError("--tune is for programs with parameters: write `parameter` instead of `const`")
    if arguments.on is not None:
        raise UsageError("--tune is not for --on: an emulated processor reads no changes")
    if source == "-" and arguments.file == "-":
        raise UsageError("--tune and the program cannot both be standard input")
    live = source == "-" and arguments.real_time
    return Tuning(program, source, live=live)


def _lines(source: str) -> list[str]:
    if source == "-":
        return list(sys.stdin)
    try:
        with open(source, encoding="utf-8") as file:
            return list(file)
    except OSError as problem:
        raise UsageError(f"--tune {described(problem)}") from None
    except UnicodeDecodeError:
        raise UsageError(f"--tune {source} is not text") from None
