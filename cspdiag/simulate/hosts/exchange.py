"""What a place sends to the others during a run, and what it receives from them."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final, Protocol

from cspdiag.runtime.channels.broadcast import Broadcast
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.kernel.exceptions import PartnerLost
from cspdiag.runtime.kernel.scheduler import Scheduler
from cspdiag.runtime.outside.drivers import Signal
from cspdiag.runtime.outside.external import EventOutput, Port, SampledOutput
from cspdiag.simulate.hosts.crossings import Crossings, without_withdrawn
from cspdiag.simulate.hosts.division import Division
from cspdiag.simulate.hosts.ends import Item
from cspdiag.simulate.hosts.links import Links
from cspdiag.simulate.hosts.messages import ended_item, error_of
from cspdiag.simulate.hosts.processes import Elsewhere
from cspdiag.simulate.hosts.standstill import Standstill

_QUEUE: Final = 8
"""How many messages may wait for their acknowledgement when the value of a signal is sent."""


class Divided(Protocol):
    """The part of a program that one place runs, as far as an exchange concerns it. ``channels`` are by name,
    ``elsewhere`` are the processes of other places by path, and ``ended`` the instances of this place that have ended,
    with their exceptions, since the others were notified.
    """

    ports: tuple[Port, ...]
    division: Division
    links: Links
    channels: dict[str, Channel[Any] | Broadcast[Any]]
    elsewhere: dict[str, Elsewhere]
    ended: list[tuple[str, BaseException | None]]


class Exchange:
    """What has happened in this place and is not sent yet, and what has arrived from the others.

    ``limit_is_reached`` is whether another place has come to the time limit, which is also that of this one;
    ``first_end`` is the place that ended first, so that the run has to end, and why. ``deadlock`` is that another place
    has ended with a deadlock, in real time; ``doom`` is why the run has to end: another place has.
    """

    def __init__(self, network: Divided, scheduler: Scheduler, *, real_time: bool) -> None:
        self._network = network
        self._division = network.division
        self._links = network.links
        self._real_time = real_time
        self._outgoing: defaultdict[str, list[tuple[Any, ...]]] = defaultdict(list)
        self.crossings = Crossings(self._division, network.channels, scheduler, self._add)
        outputs = [port for port in network.ports if isinstance(port, SampledOutput | EventOutput)]
        self._signals = {port.name: port.driver for port in outputs if type(port.driver) is Signal}
        own = [(name, signal) for name, signal in self._signals.items() if name in self._division.own_ports]
        self._known = {(other, name): signal.value for other in self._division.others for name, signal in own}
        """The values of the signals of this place as the others know them."""
        self.rounds: Mapping[str, deque[tuple[Any, ...]]] = {other: deque() for other in self._division.others}
        self._ready: set[str] = set()
        self._arrived: list[tuple[str, tuple[Any, ...]]] = []
        """The items that were received and not yet taken over; some may come before the run begins here."""
        self.standstill = Standstill(self._division, self._links)
        self.limit_is_reached = False
        self.first_end: tuple[str, str] | None = None
        self.deadlock: PartnerLost | None = None
        self.doom: PartnerLost | None = None

    @property
    def present(self) -> list[str]:
        """The other places that are still running."""
        return [other for other, link in self._links.by_place.items() if not link.over]

    @property
    def has_news(self) -> bool:
        """Whether something has arrived that was not taken over, or a link is lost."""
        return bool(self._links.inbox or self._arrived or self._links.lost)

    @property
    def has_new_signals(self) -> bool:
        """Whether signals of this place have values that another one does not know."""
        return any(self._signals[name].value is not value for (_, name), value in self._known.items())

    # What is sent

    def _add(self, place: str, item: Item) -> None:
        self._outgoing[place].append(tuple(item))

    def collect(self) -> bool:
        """Gathers what has happened here for the others; returns whether it can have an effect in this instant."""
        self.crossings.step()
        for path, error in self._network.ended:
            for other in self._division.others:
                self._outgoing[other].append(ended_item(path, error))
        self._network.ended.clear()
        return any(self._outgoing.values())

    def _collect_signals(self, place: str) -> None:
        """Adds the values of the environment's signals that a place does not know yet."""
        for (other, name), value in self._known.items():
            present = self._signals[name].value
            if other == place and present is not value:
                self._known[other, name] = present
                self._outgoing[place].append(("signal", name, present))

    def send_round(self, other: str, *, active: bool, following: int | None = None, can_continue: bool = False) -> None:
        """Sends what a place is to know at the end of a round, with the vote of this one."""
        self._collect_signals(other)
        self._links.send(other, ("round", active, following, can_continue, self._outgoing.pop(other, [])))

    def flush(self, other: str) -> None:
        """Sends what a place is to know; values of signals only while the link keeps up with them."""
        if len(self._links.by_place[other].waiting) < _QUEUE:
            self._collect_signals(other)
        items = self._outgoing.pop(other, None)
        if items:
            self.standstill.sent(other)
            self._links.send(other, ("items", items))

    # What is received

    def are_ready(self, places: Collection[str]) -> bool:
        """Whether all of these places have said that they are ready to begin."""
        return self._ready.issuperset(places)

    def receive(self) -> None:
        """Notes what has arrived since the last time."""
        inbox = self._links.inbox
        while inbox:
            place, message = inbox.popleft()
            what, *rest = message
            if what == "bye":
                self._note_end(place, *rest)
            elif what == "ready":
                self._ready.add(place)
            elif what == "round":
                self.rounds[place].append(tuple(rest))
            elif what == "idle":
                self.standstill.report(place, rest[0])
            else:
                self.standstill.received(place)
                self._arrived += [(place, tuple(item)) for item in rest[0]]

    def _note_end(self, place: str, ended: str, first: str, why: str) -> None:
        self._links.by_place[place].over = True
        self.limit_is_reached |= ended == "time limit"
        if ended in ("terminated", "time limit"):
            return
        first, why = self.first_end = self.first_end or (first, why)
        end = PartnerLost(f"the place `{first}` has ended: {why}")
        if ended == "deadlock" and self._real_time:
            self.deadlock = end
        else:
            self.doom = end

    def apply(self, place: str, items: Iterable[tuple[Any, ...]]) -> None:
        """Lets happen here what has happened in another place."""
        for what, *rest in items:
            match what:
                case "signal":
                    self._signals[rest[0]].value = rest[1]
                case "ended":
                    path, error = rest
                    self._network.elsewhere[path].end(None if error is None else error_of(*error))
                case _:  # It is about a channel.
                    self.crossings.receive(place, what, *rest)

    def apply_arrived(self) -> None:
        """Receives, and lets happen here all that was received as items."""
        arrived = defaultdict[str, list[tuple[Any, ...]]](list)
        self.receive()
        for place, item in self._arrived:
            arrived[place].append(item)
        self._arrived.clear()
        for place, items in arrived.items():
            self.apply(place, without_withdrawn(items))
