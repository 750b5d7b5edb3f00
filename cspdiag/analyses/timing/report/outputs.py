"""When the outputs of a program change after a loop has written them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from math import gcd

from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import CoreNetwork, ExternalPort


class Outputs:
    """The outputs of a program, by the nets that lead to them."""

    def __init__(self, network: CoreNetwork) -> None:
        named = zip(port_names(network.external_ports), network.external_ports, strict=True)
        ports = {name: port for name, port in named if port.direction == "out"}
        self._order = {net.path: k for k, net in enumerate(network.nets)}
        self._ports = {
            net.path: ports[_short(net.path)]
            for net in network.nets
            if net.external == "out" and _short(net.path) in ports
        }

    def names(self, written: Iterable[str]) -> tuple[str, ...]:
        """The names of the outputs at the end of some nets, in the order of the text."""
        return tuple(_short(net) for net in sorted(written, key=self._order.__getitem__))

    def interval(
        self, written: Collection[str], period: int, response: int | None, steady: Collection[str]
    ) -> tuple[int, int] | None:
        """The shortest and the longest time from a sample to outputs that are based on it; None without outputs or
        without a bound. ``steady`` are those that are written in each sample.
        """
        ports = {net: self._ports[net] for net in written if net in self._ports}
        if not ports or response is None:
            return None
        latches = [_latch(port) for port in ports.values()]
        shortest = min(0 if ticks is None else _shortest(ticks, gcd(period, ticks.period)) for ticks in latches)
        return shortest, max(_latency(port, period, response, net in steady)[0] for net, port in ports.items())

    def latency(self, net: str, period: int, response: int, is_steady: bool) -> tuple[int, int] | None:
        """The age of a sample when an output that is based on it is handed over, and the longest delay from a sample to
        the first output that is based on it or a later one. ``is_steady`` says that the loop writes it in each sample.

        None if the net leads to no output.
        """
        port = self._ports.get(net)
        return None if port is None else _latency(port, period, response, is_steady)


def _latency(port: ExternalPort, period: int, response: int, is_steady: bool) -> tuple[int, int]:
    """The age and the delay of an output: a latched one changes at the first tick after it was written, to the last
    value written before that tick; an immediate one when it is written.

    What is written in the instant of a tick is written after it, and handed over at the next one.
    """
    ticks = _latch(port)
    if ticks is None:
        return response, response
    grid = gcd(period, ticks.period)
    # Handed over at the first tick after it was written, a value comes at most a period of the output after its write.
    delay = _last(ticks, grid, response) + ticks.period
    if not is_steady:
        return delay, delay
    # The value of the next sample, which replaces it, is written at most a period and a response time after this one.
    age = _last(ticks, grid, response + period)
    return min(age, delay), delay


def _shortest(ticks: Sampling, grid: int) -> int:
    """The shortest time from a sample to a tick after it."""
    return _last(ticks, grid, 0) + grid


def _last(ticks: Sampling, grid: int, most: int) -> int:
    """The longest time from a sample to a tick that is at most ``most`` nanoseconds; negative for a tick before it.

    All times from samples to ticks differ by multiples of the grid, because samples come at multiples of their period.
    """
    return most - (most - ticks.offset) % grid


def _latch(port: ExternalPort) -> Sampling | None:
    return None if port.immediate else port.sampling


def port_names(ports: Iterable[ExternalPort]) -> list[str]:
    """The names of ports; those in an array with their numbers."""
    return [
        port.name if port.index is None or port.name.endswith("]") else f"{port.name}[{port.index}]" for port in ports
    ]


def _short(path: str) -> str:
    return path.partition(".")[2]
