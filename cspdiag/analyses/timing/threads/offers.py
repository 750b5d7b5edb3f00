"""What a process waits for when it communicates at the end of a channel."""

from __future__ import annotations

from cspdiag.analyses.timing.threads.graph import Offer
from cspdiag.base import Span
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.actions import ChannelEnd, End, Step
from cspdiag.network.ir.declared import Declared, DeclaredElement
from cspdiag.network.ir.durations import Durations
from cspdiag.network.ir.expressions import Expression, ParameterValue, SignalValue, Value
from cspdiag.network.ir.network import CoreNetwork, Net, ProcessClass


class ChannelEnds:
    """The ends of the channels of a network, and the offers of a process that communicates there."""

    def __init__(self, network: CoreNetwork) -> None:
        self._arguments = {instance.path: instance.arguments for instance in network.instances}
        self._nets = {net.path: net for net in network.nets}
        self._net_of = {end: net for net in network.nets for end in (*net.writers, *net.readers)}
        self._class_of = {instance.path: instance.class_name for instance in network.instances}
        self._durations = Durations(network)

    def net(self, path: str, end: End) -> Net | None:
        """The net at an end of a process or law."""
        if isinstance(end, ChannelEnd):
            return self._nets.get(f"{path}.{end.channel}")
        return self._net_of.get((path, end.port if end.index is None else f"{end.port}[{end.index}]"))

    def reading(
        self,
        path: str,
        end: End,
        target: int,
        where: Step | Declared | DeclaredElement,
        *,
        owner: str = "",
        takes: bool = True,
    ) -> list[Offer]:
        """What reading waits for; empty if it never waits. ``owner`` is the process that follows samples there."""
        net = self.net(path, end)
        if net is None or (net.kind == "var" and net.external is None):
            return []
        if net.external == "in" and net.sampling is not None:
            key = (net.path, owner or path, end.end)
            return [Offer("sample", target, where.span, net.path, net.sampling.period, key, takes)]
        if net.external == "in":
            return [Offer("event", target, where.span, net.path)]
        return [Offer("partner", target, where.span, net.path)]

    def writing(self, path: str, end: End, target: int, where: Step | Declared | DeclaredElement) -> list[Offer]:
        """What writing waits for; empty if it never waits."""
        net = self.net(path, end)
        if net is None or net.external is not None or net.kind in ("var", "overwrite"):
            return []
        return [Offer("partner", target, where.span, net.path, writes=True)]

    def delay(self, path: str, duration: Expression, target: int, span: Span) -> list[Offer]:
        """A delay, with period 0 if its length is computed; empty if it never waits."""
        known = self.constant(path, duration)
        if known is None or not isinstance(known, int):
            return [
                Offer(
                    "delay", target, span, takes_time=self._durations.surely_takes_time(self._class_of[path], duration)
                )
            ]
        return [Offer("delay", target, span, period=known)] if known > 0 else []

    def constant(self, path: str, expression: Expression) -> Value | None:
        """The value of an expression of a process; None if it is not constant."""
        arguments = dict(self._arguments[path])

        def lookup(part: ParameterValue | SignalValue) -> Value | None:
            return arguments.get(part.name)

        return constant_value(expression, lookup)

    def is_own(self, path: str, variable: str) -> bool:
        """Whether only the process itself, and no law or process inside it, changes its variable."""
        net = self._nets.get(f"{path}.{variable}")
        return net is None or not net.writers


def never_waits(net: Net) -> bool:
    """Whether writing never waits, though a reader may be waiting for the value."""
    return net.external is None and net.kind == "overwrite"


def capacities(network: CoreNetwork) -> dict[str, int]:
    """The number of values that each buffer and each channel that overwrites holds, by the path of its net."""
    channels = {
        entry.name: [channel for channel in entry.channels if channel.kind in ("buffer", "overwrite")]
        for entry in network.classes
        if isinstance(entry, ProcessClass)
    }
    return {
        f"{instance.path}.{channel.name}": channel.capacity or 0
        for instance in network.instances
        for channel in channels.get(instance.class_name, ())
    }
