"""Which process of a running program a trace means."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from cspdiag.runtime.deadlock.reports import DeadlockReport, WaitingProcess
from cspdiag.settings import SettingError, parse_duration
from cspdiag.verify.runs.trace import TraceStep

UNFIT = 3
WRITTEN = " (written)"
"""The end of the name of an event that begins a broadcast; each reader takes the value in an event of its own."""


def in_words(text: str, top: str) -> str:
    """A sentence with names as people see them: below the outermost process ``top``."""
    return text.replace(f"`{top}.", "`")


def below(report: DeadlockReport, top: str) -> DeadlockReport:
    """A report with such names."""

    def short(process: WaitingProcess) -> WaitingProcess:
        waits = process.waits
        for channel in process.channels:
            waits = waits.replace(channel, channel.removeprefix(f"{top}."))
        return replace(process, path=f"`{process.path.removeprefix(f'{top}.')}`", waits=waits)

    lists = (tuple(map(short, processes)) for processes in (report.waiting, report.cycle, report.others))
    return DeadlockReport(report.time, *lists)


class Named(Protocol):
    """A task in a running program: its process, and its possible names in a trace."""

    @property
    def path(self) -> str: ...  # noqa: D102
    @property
    def names(self) -> tuple[str, ...]: ...  # noqa: D102


def is_medium(name: str, step: TraceStep) -> bool:
    """Whether a party of a step is no process but the memory of its channel, or of one reading end of a broadcast."""
    channel = step.channel.removesuffix(WRITTEN)
    return name == channel or name.startswith(f"{channel} to ")


def fit(candidate: Named, name: str, path: str) -> int:
    """How well a process that halts fits one of a trace: 0 is best, and ``UNFIT`` not at all."""
    if name in candidate.names:
        return 0
    if candidate.path.startswith(f"{name}."):
        return 1
    return 2 if belongs(candidate.path, path) else UNFIT


def belongs(process: str, path: str) -> bool:
    """Whether a process is that of a path, is inside it, or runs it."""
    return process == path or process.startswith(f"{path}.") or path.startswith(f"{process}.")


def duration_of(event: str) -> int | None:
    """The duration of an event of time in nanoseconds; None if the text does not give it as a number."""
    try:
        return parse_duration(event.rpartition(": ")[2].removeprefix("after").removeprefix("wait").strip())
    except SettingError:
        return None
