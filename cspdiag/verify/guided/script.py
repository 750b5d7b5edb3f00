"""What each process does in a counterexample: the script of a run on the real runtime."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from cspdiag.base.record import record
from cspdiag.runtime.kernel.durations import shown
from cspdiag.runtime.kernel.policy import Option
from cspdiag.verify.runs.task_names import Key

LATER = 1 << 60
"""The rank of a task that has done all its entries."""


@dataclass
class Passed:
    """Something that a task has to do; ``path`` is its process, ``name`` its name in proofs.

    ``action`` and ``index`` (of a guard) are as in ``policy.Option``; ``miss`` if a sample is found overwritten.
    ``together``: its order among adjacent entries is open, as when a submodel reads its inputs. ``value`` is what the
    environment has to offer, ``words`` a delay until an instant as the text has it.
    """

    key: Key
    path: str
    action: str
    channel: str = ""
    index: int = 0
    duration: int = 0
    together: bool = False
    value: Any = None
    name: str = ""
    words: str = ""

    def __str__(self) -> str:
        return self.channel or self.action


def words_of(entry: Passed) -> str:
    """What a task has to do, in words."""
    if entry.words:
        return entry.words
    if entry.action in {"wait", "after"}:
        return f"{entry.action} {shown(entry.duration)}"
    if entry.action == "miss":
        return f"a missed sample of {entry.channel}"
    return entry.channel or entry.action


def is_option(entry: Passed, option: Option) -> bool:
    """Whether a guard does what the task has to do."""
    if option.channel:
        action = "read" if option.action == "ready" else option.action
        return entry.action == action and entry.channel == option.channel
    return entry.action == option.action and entry.index == option.index


@record
class Actor:
    """A task that took part in something: its process, its possible names in a counterexample, and the file and line at
    which it was.
    """

    path: str
    names: tuple[str, ...]
    place: str | None = None


@record
class Happened:
    """Something that tasks did in a run. ``action`` is ``communication``, or as in ``Passed``; the writer is the first
    of the actors.

    ``value`` is that of a communication, and the duration of a delay in nanoseconds.
    """

    action: str
    channel: str
    actors: tuple[Actor, ...]
    value: Any = None


@record
class Standing:
    """A task that waits forever, and the channels at which it waits."""

    actor: Actor
    channels: frozenset[str]


def put_off(entries: Sequence[Passed], channels: Container[str]) -> tuple[Passed, ...]:
    """The same entries, but those that read one of ``channels`` are as late as the reading task can wait."""
    waiting: dict[Key, list[Passed]] = {}
    found: list[Passed] = []
    for entry in entries:
        if entry.action == "read" and entry.channel in channels:
            waiting.setdefault(entry.key, []).append(entry)
        else:
            found += (*waiting.pop(entry.key, ()), entry)
    return (*found, *(entry for late in waiting.values() for entry in late))


def to_first_round(happened: Sequence[Happened], period: slice) -> tuple[tuple[Happened, ...], int]:
    """What happened up to the end of the first round of what is repeated, and the number of entries before that round;
    ``period`` is one of the rounds.
    """
    length = period.stop - period.start
    began = period.start
    while began and happened[began - 1] == happened[began - 1 + length]:
        began -= 1
    return tuple(happened[: began + length]), began


class Script:
    """What all tasks have to do, in the order of the counterexample, and which of it has been done."""

    def __init__(self, entries: Sequence[Passed]) -> None:
        self.entries = entries
        self._done = [False] * len(entries)
        self._first = 0
        self.left = len(entries)
        self._own: dict[Key, list[int]] = defaultdict(list)
        self._inside: dict[Key, list[int]] = defaultdict(list)
        self._ports: dict[str, list[int]] = defaultdict(list)
        for number, entry in enumerate(entries):
            self._own[entry.key].append(number)
            for length in range(len(entry.key) + 1):
                self._inside[entry.key[:length]].append(number)
            if entry.action in {"read", "miss"}:
                self._ports[entry.channel].append(number)
        for numbers in (*self._own.values(), *self._inside.values(), *self._ports.values()):
            numbers.reverse()

    def next(self) -> int | None:
        """The first entry that has not been done."""
        while self._first < len(self._done) and self._done[self._first]:
            self._first += 1
        return self._first if self._first < len(self._done) else None

    def head(self, key: Key) -> Passed | None:
        """What a task has to do next."""
        number = self._last(self._own.get(key))
        return None if number is None else self.entries[number]

    def next_read(self, channel: str) -> Passed | None:
        """The next entry that reads a channel, or misses a sample of it."""
        number = self._last(self._ports.get(channel))
        return None if number is None else self.entries[number]

    def undone(self) -> Iterator[Passed]:
        """The entries that have not been done."""
        return (entry for entry, done in zip(self.entries, self._done, strict=True) if not done)

    def rank(self, key: Key) -> int:
        """How early an entry of a task is: of itself, of a branch in it, or of the task that waits for it."""
        while True:
            number = self._last(self._inside.get(key))
            if number is not None:
                return number
            if not key:
                return LATER
            key = key[:-1]

    def do(self, key: Key, action: str, channel: str, index: int) -> int | None:
        """A task has done something. Returns the number of the entry if that is what it has to do next."""
        for number in self._candidates(key):
            entry = self.entries[number]
            same = entry.channel == channel if channel else entry.index == index
            if entry.action == action and same:
                self._done[number] = True
                self.left -= 1
                return number
        return None

    def _candidates(self, key: Key) -> Iterable[int]:
        numbers = self._own.get(key)
        first = self._last(numbers)
        if numbers is None or first is None:
            return
        yield first
        if not self.entries[first].together:
            return
        for position in range(len(numbers) - 2, -1, -1):
            number = numbers[position]
            if not self.entries[number].together:
                return
            if not self._done[number]:
                yield number

    def _last(self, numbers: list[int] | None) -> int | None:
        while numbers and self._done[numbers[-1]]:
            numbers.pop()
        return numbers[-1] if numbers else None
