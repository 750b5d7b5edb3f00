"""Runs a network from the command line: what ``python -m`` of a generated package does."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from .drivers import Driver
from .durations import ms, ns, s, shown, us
from .exceptions import described
from .network import Network
from .outcome import Outcome

_UNITS = {"ns": ns, "us": us, "ms": ms, "s": s, "min": 60 * s}

EXIT_CODES = {"terminated": 0, "time limit": 0, "stopped": 130, "deadlock": 1, "failed": 1}
"""By how a run ended."""


def main(
    name: str,
    build: Callable[[Mapping[str, Driver]], Network],
    environments: Mapping[str, Callable[[], Any]],
    ports: Sequence[str],
    arguments: Sequence[str] | None = None,
) -> int:
    """Run a network in one of its environments and print how that went; the exit code.

    ``ports`` are the external ports for which an environment has drivers. Without a time limit a run goes on until the program ends or
    Ctrl-C; outputs are released however it ends.
    """
    given = _parser(name, environments).parse_args(arguments)
    if not environments and ports:
        print(f"{name} has no environment; build its network with drivers for {', '.join(ports)}", file=sys.stderr)
        return 2
    environment = environments[given.environment]() if environments else None
    network = build(environment.drivers if environment is not None else {})
    outcome = network.run(
        environment=environment,
        until=given.limit,
        real_time=given.real_time,
        on_miss=getattr(environment, "on_miss", "timeout"),
    )
    print("\n".join(_summary(outcome)))
    return EXIT_CODES[outcome.ended] or (1 if outcome.release_errors else 0)


def duration(text: str) -> int:
    """``20s`` or ``1.5 ms`` in nanoseconds; ValueError for anything else."""
    match = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)\s*(ns|us|ms|s|min)", text.strip())
    if match is None:
        raise ValueError(f"{text!r} is not a duration such as 20s or 500ms")
    return round(float(match[1]) * _UNITS[match[2]])


def _parser(name: str, environments: Mapping[str, Callable[[], Any]]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=f"python -m {name}", epilog=f"example: python -m {name} --for 20s")
    if environments:
        first = next(iter(environments))
        parser.add_argument(
            "--environment",
            choices=list(environments),
            default=first,
            metavar="NAME",
            help=f"one of {', '.join(environments)} (default: {first})",
        )
    parser.add_argument("--for", dest="limit", type=duration, metavar="TIME", help="the time limit, such as 20s")
    parser.add_argument("--real-time", action="store_true", help="run against the clock, not in virtual time")
    return parser


def _summary(outcome: Outcome) -> Iterator[str]:
    why = f": {described(outcome.error)}" if outcome.error is not None else ""
    yield f"{_ending(outcome)} at {shown(outcome.time)}, in {outcome.wall_time:.3g} s{why}"
    if outcome.deadlock is not None:
        yield outcome.deadlock.text
    for port, count in outcome.missed.items():
        if count:
            yield f"missed samples of {port}: {count}"
    for period, jitter in outcome.jitter.items():
        yield f"jitter of the {shown(period)} period: {jitter}"
    for error in outcome.release_errors:
        yield f"while releasing outputs: {described(error)}"


def _ending(outcome: Outcome) -> str:
    match outcome.ended:
        case "terminated":
            return "ended by itself"
        case "time limit":
            return "reached the time limit"
        case "failed":
            return "ended unsuccessfully"
        case _:
            return outcome.ended
