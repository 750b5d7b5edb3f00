"""When the outputs of a program change after a loop has written them."""

from __future__ import annotations

from collections.abc import Iterable
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
        """Those at the end of some nets, in the order of the text."""
        return tuple(_short(net) for net in sorted(written, key=self._order.__getitem__))

    def interval(self, written: Iterable[str], period: int, response: int | None) -> tuple[int, int] | None:
        """From a sample to outputs that are based on it, the shortest and the longest time; None without outputs or
        without a bound.
        """
        ports = [self._ports[net] for net in written if net in self._ports]
        if not ports or response is None:
            return None
        latches = [_latch(port) for port in ports]
        shortest = min(0 if ticks is None else _first(ticks, gcd(period, ticks.period), 1) for ticks in latches)
        return shortest, max(_latency(port, period, response)[0] for port in ports)

    def latency(self, net: str, period: int, response: int) -> tuple[int, int] | None:
        """The age of a sample when an output that is based on it is handed over, and the delay from a sample to the
        first output that is based on it or a later one, at most; None where the net leads to no output.
        """
        port = self._ports.get(net)
        return None if port is None else _latency(port, period, response)


def _latency(port: ExternalPort, period: int, response: int) -> tuple[int, int]:
    """A latched output changes at the first of its ticks after it was written, by the last value that was; an immediate
    one when it is written.
    """
    ticks = _latch(port)
    if ticks is None:
        return response, response
    grid = gcd(period, ticks.period)
    delay = _first(ticks, grid, max(response, 1)) + ticks.period - grid
    # The last sample that has been written for certain began a response and not quite a period before the tick.
    age = max(_first(ticks, grid, 1), _first(ticks, grid, response + period) - grid)
    return min(age, delay), delay


def _first(ticks: Sampling, grid: int, least: int) -> int:
    """The least time from a sample to a tick, of those of at least the given nanoseconds: samples come at the multiples
    of their period, and so all such times differ by multiples of the grid.
    """
    return least + (ticks.offset - least) % grid


def _latch(port: ExternalPort) -> Sampling | None:
    return None if port.immediate else port.sampling


def port_names(ports: Iterable[ExternalPort]) -> list[str]:
    """Their names, those of arrays with their numbers."""
    return [
        port.name if port.index is None or port.name.endswith("]") else f"{port.name}[{port.index}]" for port in ports
    ]


def _short(path: str) -> str:
    return path.partition(".")[2]
