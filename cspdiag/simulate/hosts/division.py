"""Which part of a program belongs to which place, and what connects the places."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, Environment, Net


@record
class Crossing:
    """A channel from a writer in one place to readers in others; ``readers`` are the other places that read."""

    path: str
    is_broadcast: bool
    writer: str
    readers: tuple[str, ...]


@record
class Division:
    """A program as a place sees it: its own external ports and instances, and the channels between places."""

    place: str
    others: tuple[str, ...]
    is_first: bool
    place_of: tuple[tuple[str, str], ...]
    """The instances of the outermost process, arrays by their name alone, each with its place."""
    own_ports: frozenset[str]
    crossings: tuple[Crossing, ...]

    @property
    def first(self) -> str:
        """The place that the environment names first."""
        return self.place_of[0][1]

    def place_of_path(self, path: str) -> str:
        """The place of a process by its path: ``Jiwy.horizontal.alignL``."""
        return dict(self.place_of)[path.split(".")[1].partition("[")[0]]

    def talks_to(self, other: str) -> bool:
        """Whether a channel connects this place with another one."""
        pair = {self.place, other}
        return any(pair <= {crossing.writer, *crossing.readers} for crossing in self.crossings)


def divided(network: CoreNetwork, environment: Environment, place: str) -> Division:
    """The part of ``place``, which the environment has."""
    place_of = {name: its_place for its_place, names in environment.places for name in names}
    names = [name for name, _ in environment.places]

    def where(users: tuple[tuple[str, str], ...]) -> list[str]:
        found = (place_of[path.split(".")[1].partition("[")[0]] for path, _ in users)
        return list(dict.fromkeys(found))

    own = set()
    crossings = []
    for net in network.nets:
        if net.external is not None:
            if place in where(net.readers if net.external == "in" else net.writers):
                own.add(net.path)
        elif (crossing := _crossing(net, where(net.writers), where(net.readers))) is not None:
            crossings.append(crossing)
    return Division(
        place=place,
        others=tuple(name for name in names if name != place),
        is_first=names[0] == place,
        place_of=tuple(place_of.items()),
        own_ports=frozenset(own),
        crossings=tuple(crossings),
    )


def _crossing(net: Net, writers: list[str], readers: list[str]) -> Crossing | None:
    others = tuple(reader for reader in readers if reader not in writers)
    return Crossing(net.path, net.kind == "broadcast", writers[0], others) if writers and others else None
