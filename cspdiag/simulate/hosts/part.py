"""A program in one place: finds the other places, and makes the network that runs here."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping
from typing import Final

from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.runtime import Network
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.simulate.hosts.division import divided
from cspdiag.simulate.hosts.links import DifferentProgramError, Links, PlaceError, Transport
from cspdiag.simulate.hosts.messages import Codec
from cspdiag.simulate.hosts.run import DividedNetwork
from cspdiag.simulate.run.package import LoadedPackage

GATHERING: Final = 30.0
"""Seconds for which a place waits for the others to start."""


@record
class Seat:
    """A place that this process takes, and ``HOST:PORT``, where the first place listens."""

    place: str
    address: str


class Part:
    """The part of a program that runs in a seat; ``program`` says what all places must have in common."""

    def __init__(
        self,
        network: CoreNetwork,
        environment: Environment,
        seat: Seat,
        program: Mapping[str, str],
        transport: Callable[[bool], Transport],
        say: Callable[[str], object],
    ) -> None:
        names = [name for name, _ in environment.places]
        if seat.place not in names:
            known = f"it has {', '.join(f'`{name}`' for name in names)}" if names else "it has no places"
            raise PlaceError(f"the environment `{environment.name}` has no place `{seat.place}`; {known}")
        self.division = divided(network, environment, seat.place)
        self._seat = seat
        self._program = dict(program)
        self._transport = transport
        self._say = say
        self.links: Links | None = None

    def network(self, running: Network, package: LoadedPackage) -> DividedNetwork:
        """Finds the other places; returns the network of this one. Raises PlaceError, and Stopped."""
        types = package.module("types") if package.has("types") else None
        links = self.links = Links(
            self._transport(self.division.is_first),
            Codec(types),
            self.division.place,
            self.division.others,
            self._program,
        )
        links.open()
        until = time.monotonic() + GATHERING
        said = False
        since = time.monotonic()
        while missing := links.missing:
            links.wait(0.05)
            stopping.check()
            _give_up_if_hopeless(links)
            if not said and time.monotonic() - since > 0.5:
                said = True
                self._say(f"waiting for {_listed(missing)}")
            if time.monotonic() > until:
                how = f"--place {missing[0]}@{self._seat.address}"
                raise PlaceError(f"no process has {_listed(missing)} after {GATHERING:g} s: start one with {how}")
        links.begun = True
        return DividedNetwork(running, self.division, links)

    def close(self) -> None:
        """Leaves."""
        if self.links is not None:
            self.links.close()


def _give_up_if_hopeless(links: Links) -> None:
    """Raises PlaceError if the places cannot run together, as this one sees or another one has reported."""
    for _, (what, *rest) in tuple(links.inbox):
        if what == "bye":
            _, place, why = rest
            raise PlaceError(f"the place `{place}` has ended: {why}")
    if isinstance(links.problem, DifferentProgramError):
        links.broadcast(("bye", "failed", links.place, str(links.problem)))
    if links.problem is not None:
        raise links.problem


def fingerprint(files: Mapping[str, str]) -> str:
    """A text that differs if any generated file does."""
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(f"{path}\0{files[path]}\0".encode())
    return digest.hexdigest()


def _listed(places: list[str]) -> str:
    return ("the place " if len(places) == 1 else "the places ") + ", ".join(f"`{place}`" for place in places)
