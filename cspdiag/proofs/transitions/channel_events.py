"""The events of channels: which threads take part in each communication, and with which of their labels."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import product
from math import prod
from typing import Any, TypeAlias, assert_never

from cspdiag.network.dump.expression import value_text
from cspdiag.proofs.transitions.occurrences import MediumFacts
from cspdiag.proofs.transitions.ranges import Range
from cspdiag.proofs.transitions.ranges import text as range_text
from cspdiag.proofs.transitions.systems import media
from cspdiag.proofs.transitions.systems.labels import (
    Alarm,
    Bind,
    Bound,
    Delivered,
    Guarded,
    Label,
    Load,
    Offer,
    OnMedium,
    Read,
    Store,
    Withdrawn,
    Write,
)
from cspdiag.proofs.transitions.systems.system import Abstraction, Component, Event, EventKind
from cspdiag.proofs.transitions.threads.alarms import bindings, side_of
from cspdiag.proofs.transitions.threads.explore import TransitionError
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import ThreadInstance, ThreadTree
from cspdiag.proofs.transitions.values import ANY, UNKNOWN, CopiedValue, Known, UnknownValue

Use: TypeAlias = tuple[ThreadInstance, OnMedium]
"""What a thread does on a medium."""
Valued: TypeAlias = Read | Write | Guarded | Load | Store

Reader: TypeAlias = tuple[ThreadInstance, Read]

_ROLES: dict[type[Valued], str] = {Read: "?.", Write: "!.", Guarded: "!.", Load: "*.", Store: "*."}
"""What each party does in an event of a thread with the component of a medium."""

MOST_COMBINATIONS = 1_000_000
"""A program is refused if more combinations of threads can communicate on one channel."""


class ChannelEvents:
    """Makes the events of all channels."""

    def __init__(self, tree: ThreadTree) -> None:
        self.threads = tree.all()
        self.events: list[Event] = []
        self.extra: list[Component] = []
        """Components that are not threads."""
        self.abstractions: dict[Abstraction, None] = {}
        self._of: list[dict[Label, list[int]]] = [{} for _ in self.threads]
        self._echoes: list[dict[Label, list[int]]] = [{} for _ in self.threads]
        """Events that show what a thread offers, and leave it in its state."""
        self._of_the_unsteady: set[int] = set()
        """Those echoes that belong only to states in which the offer may be withdrawn."""
        self._alarms: dict[MediumFacts, list[tuple[ThreadInstance, Alarm]]] = defaultdict(list)
        self._nobody: int | None = None

    def _event(
        self,
        channel: str,
        parties: tuple[int, ...],
        kind: EventKind,
        value: Known = UNKNOWN,
        type_: Any = None,
        *,
        visible: bool = False,
        roles: str = "",
        instant: bool = False,
    ) -> int:
        text = _text(value, type_)
        self.events.append(Event(channel, parties, kind, text, visible, roles, instant))
        return len(self.events) - 1

    def _for(self, thread: ThreadInstance, label: Label, event: int) -> None:
        self._of[thread.number].setdefault(label, []).append(event)

    def _add(self, component: Component) -> int:
        self.extra.append(component)
        return len(self.threads) + len(self.extra) - 1

    def _nobody_number(self) -> int:
        if self._nobody is None:
            self._nobody = self._add(media.nobody())
        return self._nobody

    def _alarm(self, thread: ThreadInstance, label: Alarm) -> None:
        """Notes that the guard of an interrupt is found ready before it is taken."""
        medium = resolve(thread.occurrence, label.reference)
        if medium.kind == "event":
            self._for(thread, label, self._event(medium.name, (thread.number,), "ready"))
        else:
            self._alarms[medium].append((thread, label))

    def _ring(
        self,
        medium: MediumFacts,
        watcher: tuple[ThreadInstance, Alarm],
        others: Iterable[Use],
        latch: tuple[int, ...] = (),
    ) -> int:
        """The event in which the guard of an interrupt is found ready; the threads that would communicate stay in their
        states.
        """
        thread, alarm = watcher
        parties = (thread.number, *dict.fromkeys(other.number for other, _ in others), *latch)
        event = self._event(medium.name, parties, "ready")
        self._for(thread, alarm, event)
        for other, offered in others:
            self._echoes[other.number].setdefault(offered, []).append(event)
        return event

    def _ring_rendezvous(self, medium: MediumFacts, uses: list[Use]) -> None:
        for thread, alarm in self._alarms.get(medium, ()):
            for use in uses:
                if use[0] is not thread and isinstance(use[1], Offer) and side_of(use[1]) == alarm.side:
                    event = self._ring(medium, (thread, alarm), [use])
                    if not medium.is_contended:
                        self._of_the_unsteady.add(event)

    def meet(self, medium: MediumFacts, uses: list[Use]) -> None:
        """Makes the events of a channel from what threads may do on it."""
        match medium.kind:
            case "sync" | "any":
                self._rendezvous(medium, uses)
                self._bind(medium, uses)
                self._ring_rendezvous(medium, uses)
            case "buffer" | "overwrite":
                self._queue(medium, uses)
            case "broadcast":
                self._broadcast(medium, uses)
                self._bind(medium, uses)
            case "var":
                self._variable(medium, uses)
            case "sampled" | "event" | "output" | "constant" | "discard":
                raise AssertionError(f"threads do not meet on what is {medium.kind}")
            case _:
                assert_never(medium.kind)

    def _value(self, medium: MediumFacts, label: Valued) -> Known:
        """The value of a label as far as the values of the medium are distinguished."""
        return medium.distinguished(label.value) if medium.relevant and medium.values is not None else UNKNOWN

    def _rendezvous(self, medium: MediumFacts, uses: list[Use]) -> None:
        writing: dict[Known, list[tuple[ThreadInstance, Write | Guarded]]] = defaultdict(list)
        reading: dict[Known, list[tuple[ThreadInstance, Read]]] = defaultdict(list)
        for thread, label in uses:
            match label:
                case Read():
                    reading[self._value(medium, label)].append((thread, label))
                case Write() | Guarded():
                    writing[self._value(medium, label)].append((thread, label))
                case Bind() | Bound() | Delivered() | Withdrawn() | Load() | Store():
                    pass
                case _:
                    assert_never(label)
        for value in dict.fromkeys([*writing, *reading]):
            self._limit(medium, len(writing.get(value, ())) * len(reading.get(value, ())))
            met: set[Use] = set()
            for (writer, written), (reader, read) in product(writing.get(value, ()), reading.get(value, ())):
                if writer is reader or (read.late and isinstance(written, Write)):
                    continue
                met |= {(writer, written), (reader, read)}
                parties = (writer.number, reader.number)
                event = self._event(medium.name, parties, "communication", value, medium.type, roles="!?")
                self._for(writer, written, event)
                self._for(reader, read, event)
            for use in (*writing.get(value, ()), *reading.get(value, ())):
                if use not in met and not (isinstance(use[1], Read) and use[1].late):
                    self._alone(medium, use, value)

    def _bind(self, medium: MediumFacts, uses: list[Use]) -> None:
        for (writer, binds), (reader, bound) in bindings(uses):
            event = self._event(medium.name, (writer.number, reader.number), "ready")
            self._for(writer, binds, event)
            self._for(reader, bound, event)

    def _limit(self, medium: MediumFacts, combinations: int) -> None:
        if combinations > MOST_COMBINATIONS:
            raise TransitionError(
                f"on `{medium.name}` {combinations} ways to communicate would have to be distinguished"
            )

    def _alone(self, medium: MediumFacts, use: Use, value: Known) -> None:
        thread, label = use
        parties = (thread.number, self._nobody_number())
        roles = "?." if isinstance(label, Read) else "!."
        self._for(thread, label, self._event(medium.name, parties, "communication", value, medium.type, roles=roles))

    def _with(
        self, medium: MediumFacts, uses: Iterable[Use], number: int, kinds: tuple[type[Valued], ...], kind: EventKind
    ) -> dict[Known, list[int]]:
        """Makes the events in which labels of some kinds meet the component of a medium, by value."""
        found: dict[Known, list[int]] = {}
        for thread, label in uses:
            if isinstance(label, kinds):
                value = self._value(medium, label)
                roles = _ROLES[type(label)]
                event = self._event(medium.name, (thread.number, number), kind, value, medium.type, roles=roles)
                self._for(thread, label, event)
                found.setdefault(value, []).append(event)
        return found

    def _queue(self, medium: MediumFacts, uses: list[Use]) -> None:
        number = len(self.threads) + len(self.extra)
        writes = self._with(medium, uses, number, (Write, Guarded), "communication")
        reads = self._with(medium, uses, number, (Read,), "take")
        if media.counts_only(medium, [*writes, *reads]):
            self.abstractions[Abstraction(f"the values in `{medium.name}` are not distinguished", medium.span)] = None
        self._add(media.queue(medium, writes, reads))

    def _variable(self, medium: MediumFacts, uses: list[Use]) -> None:
        number = len(self.threads) + len(self.extra)
        loads = self._with(medium, uses, number, (Load,), "variable")
        stores = self._with(medium, uses, number, (Store,), "variable")
        self._add(media.variable(medium, loads, stores))

    def _broadcast(self, medium: MediumFacts, uses: list[Use]) -> None:
        readers: dict[object, list[Reader]] = {}
        for thread, label in uses:
            if isinstance(label, Read):
                end = thread.occurrence.at(label.end.path), label.end.end
                readers.setdefault(end, []).append((thread, label))
        first = len(self.threads) + len(self.extra)
        missing = max(0, medium.ends - len(readers))
        latches = tuple(range(first, first + len(readers)))
        absent = (self._nobody_number(),) if missing and self._nobody is not None else ()
        if missing and not absent:
            latches = tuple(number + 1 for number in latches)
            absent = (self._nobody_number(),)
        writes, delivered, withdrawn = self._broadcast_writes(medium, uses, latches, absent)
        taken: list[dict[Known, list[int]]] = []
        for number, ends in zip(latches, readers.values(), strict=True):
            waiting = [use for use in ends if not use[1].late]
            taken.append(self._with(medium, waiting, number, (Read,), "communication"))
        self._guarded_broadcasts(medium, uses, list(readers.values()), absent)
        for number, takes, ends in zip(latches, taken, readers.values(), strict=True):
            seen = self._ring_latch(medium, ends, number) if withdrawn else []
            name = f"{medium.name} to {ends[0][0].name}"
            self._add(media.latch(name, writes, takes, delivered, withdrawn, seen))

    def _ring_latch(self, medium: MediumFacts, ends: list[Reader], number: int) -> list[int]:
        """The events in which guards of interrupts see a value at their end of a broadcast that may still be taken
        back.
        """
        where = {(thread, label.end) for thread, label in ends}
        watchers = [use for use in self._alarms.get(medium, ()) if (use[0], use[1].end) in where]
        return [self._ring(medium, watcher, (), (number,)) for watcher in watchers]

    def _broadcast_writes(
        self, medium: MediumFacts, uses: list[Use], latches: tuple[int, ...], absent: tuple[int, ...]
    ) -> tuple[dict[Known, list[int]], list[int], list[int]]:
        writes: dict[Known, list[int]] = {}
        delivered: list[int] = []
        withdrawn: list[int] = []
        for thread, label in uses:
            parties = (thread.number, *latches)
            match label:
                case Write():
                    value = self._value(medium, label)
                    roles = "!" + "." * len(latches)
                    event = self._event(f"{medium.name} (written)", parties, "take", value, medium.type, roles=roles)
                    writes.setdefault(value, []).append(event)
                case Delivered():
                    event = self._event(f"{medium.name} (taken by all)", (*parties, *absent), "delivered")
                    delivered.append(event)
                case Withdrawn():
                    event = self._event(f"{medium.name} (taken back)", parties, "delivered")
                    withdrawn.append(event)
                case Read() | Guarded() | Bind() | Bound() | Load() | Store():
                    continue
                case _:
                    assert_never(label)
            self._for(thread, label, event)
        return writes, delivered, withdrawn

    def _guarded_broadcasts(
        self, medium: MediumFacts, uses: list[Use], readers: list[list[Reader]], absent: tuple[int, ...]
    ) -> None:
        """An output guard on a broadcast is ready when all readers wait; all get the value at once."""
        for thread, label in uses:
            if not isinstance(label, Guarded):
                continue
            value = self._value(medium, label)
            fitting = [[use for use in ends if self._value(medium, use[1]) == value] for ends in readers]
            self._limit(medium, prod(map(len, fitting)))
            for chosen in product(*fitting):
                reading = tuple(dict.fromkeys(reader.number for reader, _ in chosen))
                parties, roles = (thread.number, *reading, *absent), f"!{'?' * len(reading)}{'.' * len(absent)}"
                event = self._event(medium.name, parties, "communication", value, medium.type, roles=roles)
                self._for(thread, label, event)
                for reader, read in chosen:
                    self._for(reader, read, event)
                self._ring_all(medium, ((thread, label), *chosen))

    def _ring_all(self, medium: MediumFacts, parties: Sequence[tuple[ThreadInstance, Read | Guarded]]) -> None:
        """For each thread whose part in a broadcast by an output guard is the guard of an interrupt: the event in which
        it sees the others ready.
        """
        for thread, label in parties:
            for watcher, alarm in self._alarms.get(medium, ()):
                own = label.end == alarm.end if isinstance(label, Read) else alarm.side == "read"
                if watcher is thread and own:
                    others = [other for other in parties if other[0] is not thread]
                    self._ring(medium, (watcher, alarm), others)


def _text(value: Known, kind: Any) -> str | None:
    """The text of a value as far as it is distinguished; ``-0.0`` is written as zero."""
    match value:
        case Range():
            return range_text(value, kind)
        case CopiedValue():
            return None if value == ANY else str(value)
        case float():
            return value_text(value + 0.0, kind)
        case UnknownValue():
            return None
        case int() | str() | tuple():
            return value_text(value, kind)
        case _:
            assert_never(value)
