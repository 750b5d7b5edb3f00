"""The channels between a place and the others, all together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from cspdiag.runtime.channels.broadcast import Broadcast, BroadcastEnd
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.kernel.scheduler import Scheduler
from cspdiag.simulate.hosts.division import Division
from cspdiag.simulate.hosts.ends import ReceivingEnd, Send, SendingEnd


class Crossings:
    """The ends, in this place, of all channels to and from others; ``send`` sends what happens at them."""

    def __init__(
        self,
        division: Division,
        channels: Mapping[str, Channel[Any] | Broadcast[Any]],
        scheduler: Scheduler,
        send: Send,
    ) -> None:
        self.paths = frozenset(crossing.path for crossing in division.crossings)
        self._sending: dict[tuple[str, str], SendingEnd] = {}
        self._receiving: dict[str, ReceivingEnd] = {}
        for crossing in division.crossings:
            channel = channels[crossing.path]
            if division.place == crossing.writer:
                _keep_own_ends(channel, division)
                for reader in crossing.readers:
                    end = channel.reader() if isinstance(channel, Broadcast) else channel
                    assert isinstance(end, Channel | BroadcastEnd)
                    self._sending[reader, crossing.path] = SendingEnd(end, reader, send)
            elif division.place in crossing.readers:
                _keep_own_ends(channel, division)
                self._receiving[crossing.path] = ReceivingEnd(channel, crossing.writer, scheduler, send)

    def step(self) -> None:
        """Tells the readers elsewhere what the writers of this place have begun and given up since the last step."""
        for end in self._sending.values():
            end.step()

    def receive(self, place: str, doing: str, channel: str, number: int, value: Any, writer: str) -> None:
        """An item of another place has arrived."""
        match doing:
            case "offer":
                self._receiving[channel].offer(number, value, writer)
            case "withdraw":
                self._receiving[channel].withdraw(number)
            case "taken":
                self._sending[place, channel].taken(number)
            case "returned":
                self._sending[place, channel].returned(number)
            case _:
                raise AssertionError(doing)

    def hand_back(self, place: str) -> None:
        """A place is lost: nobody takes what its writers have offered, as they may have given it up by now."""
        for end in self._receiving.values():
            if end.place == place:
                end.hand_back()

    def waiting_for(self, place: str) -> frozenset[str]:
        """The channels at which this place waits for another one, or would if a process waited there."""
        read = {path for path, end in self._receiving.items() if end.place == place}
        written = {path for (other, path), end in self._sending.items() if other == place and end.waits}
        return frozenset(read | written)


def _keep_own_ends(channel: Channel[Any] | Broadcast[Any], division: Division) -> None:
    """The readers elsewhere get the values of a broadcast in their own place."""
    if isinstance(channel, Broadcast):
        channel.ends = [end for end in channel.ends if division.place_of_path(end.owner) == division.place]


def without_withdrawn(items: Iterable[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    """Items that have arrived together, without the offers that are withdrawn by a later one: a reader that waits would
    take them before.
    """
    kept: list[tuple[Any, ...]] = []
    withdrawn: set[tuple[Any, ...]] = set()
    for item in reversed(list(items)):
        if item[0] == "withdraw":
            withdrawn.add(item[1:3])
        if item[0] != "offer" or item[1:3] not in withdrawn:
            kept.append(item)
    return kept[::-1]
