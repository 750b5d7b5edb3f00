"""``run --place``: this process runs one place of a program."""

from __future__ import annotations

import re
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from ipaddress import IPv6Address
from typing import TYPE_CHECKING

from cspdiag.cli.support.failure import NoResultError, UsageError
from cspdiag.cli.support.runs.standstill import ProgramInPlace, ProgramInThread
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.cli.support.runs.requested import RequestedRun
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.network import Network
    from cspdiag.simulate.hosts.part import Part, Seat
    from cspdiag.simulate.record.modes import ModeGroup
    from cspdiag.simulate.run.package import LoadedPackage

_SEAT = re.compile(r"(?P<place>[^@]+)@(?P<host>\[[^\[\]]+\]|[^@:\[\]]+):(?P<port>[0-9]+)")


def seat_of(text: str) -> Seat:
    """What ``--place`` names. Raises UsageError."""
    from cspdiag.simulate.hosts.part import Seat

    found = _SEAT.fullmatch(text)
    try:
        if found is None or not 0 < int(found["port"]) < 65536:
            raise ValueError(text)
        address = IPv6Address(found["host"][1:-1]) if found["host"].startswith("[") else None
    except ValueError:
        raise UsageError(
            f"--place {text}: write NAME@HOST:PORT, such as pan@192.168.1.7:7447 or pan@[fd00::7]:7447"
        ) from None
    if address is not None and address.is_link_local and address.scope_id is None:
        raise UsageError(
            f"--place {text}: many networks have an address {address}: name this machine's interface to the one that "
            f"is meant, such as [{address}%eth0]"
        )
    return Seat(found["place"], f"{found['host']}:{found['port']}")


def refuse_unsupported(arguments: Namespace) -> None:
    """Raises UsageError for options that a place does not have."""
    seat_of(arguments.place)
    refused = {
        "--target": (arguments.target != "python", "places run in Python"),
        "-O reference": (arguments.level == "reference", "places run readable code"),
        "--inputs": (arguments.inputs is not None, "a recording has the inputs of all places"),
        "--tune without a file": (arguments.tune == "-", "what is typed would reach this place only"),
    }
    for option, (given, why) in refused.items():
        if given:
            raise UsageError(f"{option} is not for --place: {why}")


def shown_groups(arguments: Namespace, network: CoreNetwork) -> tuple[ModeGroup, ...]:
    """The groups that the progress of a run shows; of a place, those that run in it. Raises UsageError, and
    NoEnvironmentError.
    """
    from cspdiag.simulate.record.modes import ModeGroup, mode_groups
    from cspdiag.simulate.run.execute import chosen_environment

    groups = mode_groups(network)
    if arguments.place is None:
        return groups
    environment = chosen_environment(network, arguments.environment)
    places = () if environment is None else environment.places
    here = seat_of(arguments.place).place
    elsewhere = {name for place, names in places if place != here for name in names}

    def own(modes: Mapping[str, str]) -> dict[str, str]:
        return {path: name for path, name in modes.items() if _instance(path) not in elsewhere}

    return tuple(ModeGroup(group.name, own(group.modes), group.ports) for group in groups)


def _instance(path: str) -> str:
    """The instance of the outermost process, without its index, that a process is in: ``Jiwy.horizontal.alignL``."""
    return path.split(".")[1].partition("[")[0]


def observed(running: Network) -> ProgramInThread:
    """What watchers see of a running place."""
    from cspdiag.simulate.hosts.run import DividedNetwork

    assert isinstance(running, DividedNetwork)
    return ProgramInPlace(running)


@contextmanager
def placed(run: RequestedRun, files: Mapping[str, str]) -> Iterator[Callable[[Network, LoadedPackage], Network] | None]:
    """What makes the network of the place that ``--place`` names out of that of the whole program; None without it."""
    from cspdiag.simulate.hosts.links import PlaceError

    if run.arguments.place is None:
        yield None
        return
    part = _part(run, files)
    try:
        yield part.network
    except PlaceError as problem:
        raise NoResultError(str(problem)) from None
    finally:
        part.close()


def _part(run: RequestedRun, files: Mapping[str, str]) -> Part:
    """Connected with the other places. Raises UsageError, and NoEnvironmentError."""
    from cspdiag.simulate.hosts.links import PlaceError
    from cspdiag.simulate.hosts.network import ZenohTransport
    from cspdiag.simulate.hosts.part import GATHERING, Part, fingerprint
    from cspdiag.simulate.run.execute import chosen_environment

    arguments, network = run.arguments, run.network
    environment = chosen_environment(network, arguments.environment)
    if environment is None:
        raise UsageError("--place: the program has no environment, so it has no places")
    seat = seat_of(arguments.place)
    changes = [(change.time, change.parameter, change.path, change.value) for change in run.given.changes]
    program = {
        "program": fingerprint(files),
        "environment": environment.name,
        "clock": "real time" if arguments.real_time else "virtual time",
        "time limit": str(arguments.until),
        "list of changes": repr(changes),
    }

    def transport(listens: bool) -> ZenohTransport:
        room = f"cspdiag/{network.top}/{environment.name}"
        return ZenohTransport(seat.address, room, listens=listens, patience=GATHERING)

    try:
        return Part(network, environment, seat, program, transport, lambda text: say(f"cspdiag: {text}"))
    except PlaceError as problem:
        raise UsageError(f"--place {arguments.place}: {problem}") from None
