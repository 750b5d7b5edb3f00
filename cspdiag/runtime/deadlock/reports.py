"""The report of a deadlock as data, and its words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..kernel.durations import shown


@dataclass(frozen=True)
class WaitingProcess:
    """A process, or one of its parallel parts, that can never continue.

    ``path`` and ``source`` are those of the process (file and line of its definition), ``place`` is the file and line
    at which it waits, ``waits`` says for what, ``channels`` are the channels' names, ``partners`` the paths of the
    processes that could still communicate with it, ``missing`` those of the readers of its broadcasts that have not
    read what it writes, and ``ended`` those among them that have ended.
    """

    path: str
    source: str | None
    place: str | None
    waits: str
    channels: tuple[str, ...]
    partners: tuple[str, ...]
    ended: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    def __str__(self) -> str:
        name = self.path or "a process"
        place = self.place or self.source
        return f"{name} waits {self.waits}" + ("" if place is None else f" ({place})")


MOST_SHOWN = 24


@dataclass(frozen=True)
class DeadlockReport:
    """All processes that wait, and those among them that wait for each other, each for the next and the last for the
    first.

    ``cycle`` is empty when no such ring was found: then some process waits for what no process does any more.
    """

    time: int
    waiting: tuple[WaitingProcess, ...]
    cycle: tuple[WaitingProcess, ...]
    others: tuple[WaitingProcess, ...] = ()
    """Processes that do continue: then it is not a deadlock, but those that wait do so forever."""

    @property
    def besides(self) -> tuple[WaitingProcess, ...]:
        """Those that wait outside the cycle."""
        rest = list(self.waiting)
        for process in self.cycle:
            rest.remove(process)  # One only: others may wait alike.
        return tuple(rest)

    @property
    def text(self) -> str:
        """The report for people: a line for each process or parallel part, of many only the first and last."""
        return "\n".join([self._stuck, *self._continuing])

    @property
    def _continuing(self) -> list[str]:
        return ["while others continue:"] * bool(self.others) + [f"  {process}" for process in self.others]

    @property
    def _stuck(self) -> str:
        kind = "stuck" if self.others else "deadlock"
        if self.cycle:
            lines = [f"{kind} at {shown(self.time)}: {_counted(self.cycle)} wait for each other"]
            following = (*self.cycle[1:], self.cycle[0])
            lines += _shortened(
                f"  {process}, for {_partner(partner, process)}{_ended_readers(process, ' and for')}"
                for process, partner in zip(self.cycle, following, strict=True)
            )
            besides = _shortened(f"  {process}{_ended_readers(process, ', for')}" for process in self.besides)
            return "\n".join(lines + ["besides:"] * bool(besides) + besides)
        which = "these processes wait" if self.others else "a process waits"
        lines = [f"{kind} at {shown(self.time)}: nothing that {which} for can happen any more"]
        lines += _shortened(
            f"  {process}{_ended_readers(process, ', for') or missing_partner(process)}" for process in self.waiting
        )
        return "\n".join(lines)


def _shortened(lines: Iterable[str]) -> list[str]:
    """The first and last of many lines."""
    found = list(lines)
    left_out = len(found) - MOST_SHOWN
    return found if left_out <= 0 else [*found[:-2][: MOST_SHOWN - 2], f"  ... {left_out} more ...", *found[-2:]]


def missing_partner(process: WaitingProcess) -> str:
    """``; no other process that still runs writes to it``; "" if one may, or if it does not wait for a channel."""
    if process.partners or not process.channels:
        return ""
    several = len(process.channels) > 1
    if "to write" not in process.waits:
        does = f"writes to {'any of them' if several else 'it'}"
    elif "to read" not in process.waits:
        does = f"can take {'any of the values' if several else 'the value'}"
    else:
        does = "is at the other side of any of them"
    return f"; no other process that still runs {does}"


def _counted(cycle: tuple[WaitingProcess, ...]) -> str:
    """``3 processes``; with several parts of one process ``2 parallel parts of Main`` or ``3 parts of 2 processes``."""
    paths = {process.path for process in cycle}
    if len(paths) == len(cycle):
        return f"{len(cycle)} processes"
    if len(paths) == 1:
        return f"{len(cycle)} parallel parts of {cycle[0].path or 'a process'}"
    return f"{len(cycle)} parts of {len(paths)} processes"


def _partner(partner: WaitingProcess, process: WaitingProcess) -> str:
    return "another part of it" if partner.path == process.path else partner.path


def _ended_readers(process: WaitingProcess, before: str) -> str:
    """``, for Main.r, which has ended``; "" if no reader has ended."""
    if not process.ended:
        return ""
    return f"{before} {', '.join(process.ended)}, which {'has' if len(process.ended) == 1 else 'have'} ended"
