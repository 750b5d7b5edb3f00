"""The instances of a network by path, and the nets with all their writers and readers."""

from __future__ import annotations

from cspdiag.base import Span
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import Type
from cspdiag.network.infer.own_uses import own_uses
from cspdiag.network.ir.network import ChannelKind, Direction, ExternalPort, Instantiation, Net
from cspdiag.network.lower.classes import Classes
from cspdiag.network.occurrences import LawOccurrence, Occurrence
from cspdiag.network.shapes import InstanceShape, Key, Shape, attached_key


class _OpenNet:
    """A net while its users are collected."""

    __slots__ = ("external", "kind", "path", "readers", "sampling", "span", "type", "writers")

    def __init__(
        self,
        path: str,
        kind: ChannelKind,
        type_: Type,
        external: Direction | None,
        sampling: Sampling | None,
        span: Span,
    ) -> None:
        self.path = path
        self.kind = kind
        self.type = type_
        self.external = external
        self.sampling = sampling
        self.span = span
        self.writers: list[tuple[str, str]] = []
        self.readers: list[tuple[str, str]] = []

    def closed(self) -> Net:
        return Net(
            path=self.path,
            kind=self.kind,
            type=self.type,
            external=self.external,
            sampling=self.sampling,
            writers=tuple(self.writers),
            readers=tuple(self.readers),
            span=self.span,
        )


def walk_instances(
    top: Occurrence, classes: Classes, ports: tuple[ExternalPort, ...]
) -> tuple[tuple[Instantiation, ...], tuple[Net, ...]]:
    """All instances, outermost first and in text order, and all nets: the external ports, then the channels by owner.

    A variable that only its own process uses is not a net.
    """
    walk = _Walk(classes)
    walk.run(top, ports)
    nets = (net.closed() for net in walk.nets if net.external or net.writers or net.readers)
    return tuple(walk.instances), tuple(nets)


class _Walk:
    """Walks over the instances without recursion; ``attached`` are the nets behind the ports of each instance."""

    def __init__(self, classes: Classes) -> None:
        self.classes = classes
        self.instances: list[Instantiation] = []
        self.nets: list[_OpenNet] = []
        self._own_uses: dict[Shape, tuple[list[Key], list[Key]]] = {}

    def run(self, top: Occurrence, ports: tuple[ExternalPort, ...]) -> None:
        path = self.classes.class_of[top]
        outside: dict[Key, _OpenNet] = {}
        for port in ports:
            outside[port.name] = self._net(
                _OpenNet(f"{path}.{port.name}", port.kind, port.type, port.direction, port.sampling, port.span)
            )
        pending: list[tuple[str, Occurrence | LawOccurrence, dict[Key, _OpenNet]]] = [(path, top, outside)]
        while pending:
            path, occurrence, attached = pending.pop()
            self._instantiate(path, occurrence)
            if isinstance(occurrence, Occurrence):
                self._own_nets(path, occurrence, attached)
                inside = [
                    (inner := f"{path}.{name}", occurrence.children[name], self._inner_nets(inner, instance, attached))
                    for name, instance in occurrence.placed.shape.instances.items()
                ]
                pending.extend(reversed(inside))

    def _net(self, net: _OpenNet) -> _OpenNet:
        self.nets.append(net)
        return net

    def _instantiate(self, path: str, occurrence: Occurrence | LawOccurrence) -> None:
        name = self.classes.class_of[occurrence]
        arguments = tuple(occurrence.arguments().items())
        self.instances.append(Instantiation(path=path, class_name=name, arguments=arguments))

    def _own_nets(self, path: str, occurrence: Occurrence, attached: dict[Key, _OpenNet]) -> None:
        """Adds the channels that a process owns to the nets behind its ports, and the process to the users of the nets
        that it uses itself.
        """
        shape = occurrence.placed.shape
        for channel in shape.channels.values():
            sampling = occurrence.placed.sampling(channel.name)
            attached[channel.name] = self._net(
                _OpenNet(f"{path}.{channel.name}", channel.kind, channel.type, None, sampling, channel.span)
            )
        if shape not in self._own_uses:
            self._own_uses[shape] = own_uses(shape)
        writes, reads = self._own_uses[shape]
        for key in writes:
            if key in attached:
                attached[key].writers.append((path, key))
        for key in reads:
            if key in attached:
                attached[key].readers.append((path, key))

    def _inner_nets(self, path: str, instance: InstanceShape, attached: dict[Key, _OpenNet]) -> dict[Key, _OpenNet]:
        """The nets behind the ports of an instance; an instance without processes inside becomes a writer or reader of
        them.
        """
        nets: dict[Key, _OpenNet] = {}
        leaf = instance.shape.is_submodel or instance.shape.is_external
        for element, attachment in instance.attachments.items():
            outer = attached_key(attachment)
            net = attached.get(outer) if outer is not None else None
            if net is None:
                continue
            key = instance.shape.element_keys[element]
            nets[key] = net
            if leaf:
                is_input = instance.shape.ports[element[0]].direction == "in"
                (net.readers if is_input else net.writers).append((path, key))
        return nets
