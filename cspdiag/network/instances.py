"""The instances of a network by their paths, and the nets with everyone who takes part in them."""

from __future__ import annotations

from cspdiag.diagnostics import Span
from cspdiag.model.types import Type
from cspdiag.network.actions import Choice as ChoiceAction
from cspdiag.network.actions import (
    InputEvent,
    InterruptOn,
    OutputEvent,
    ReadValue,
    ReadyEvent,
    WriteValue,
)
from cspdiag.network.ends import all_actions
from cspdiag.network.ir import ChannelKind, Direction, ExternalPort, Instantiation, Net
from cspdiag.network.lower_classes import Classes
from cspdiag.network.occurrences import LawOccurrence, Occurrence
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key, Shape, attached_key, element_name


class _OpenNet:
    """A net while its users are collected."""

    __slots__ = ("external", "kind", "path", "period", "readers", "span", "type", "writers")

    def __init__(
        self, path: str, kind: ChannelKind, type_: Type, external: Direction | None, period: int | None, span: Span
    ) -> None:
        self.path = path
        self.kind = kind
        self.type = type_
        self.external = external
        self.period = period
        self.span = span
        self.writers: list[tuple[str, str]] = []
        self.readers: list[tuple[str, str]] = []

    def closed(self) -> Net:
        return Net(
            path=self.path,
            kind=self.kind,
            type=self.type,
            external=self.external,
            period=self.period,
            writers=tuple(self.writers),
            readers=tuple(self.readers),
            span=self.span,
        )


def walk_instances(
    top: Occurrence, classes: Classes, ports: tuple[ExternalPort, ...]
) -> tuple[tuple[Instantiation, ...], tuple[Net, ...]]:
    """All instances, outermost first and in text order, and all nets: the external ports, then the channels by owner.

    A variable that only its own process uses is no net."""
    instances: list[Instantiation] = []
    nets: list[_OpenNet] = []
    own_uses: dict[Shape, tuple[list[Key], list[Key]]] = {}
    path = classes.class_of[top]
    outside: dict[Key, _OpenNet] = {}
    for port in ports:
        net = _OpenNet(f"{path}.{port.name}", port.kind, port.type, port.direction, port.period, port.span)
        outside[port.name] = net
        nets.append(net)
    pending: list[tuple[str, Occurrence | LawOccurrence, dict[Key, _OpenNet]]] = [(path, top, outside)]
    while pending:
        path, occurrence, attached = pending.pop()
        name = classes.class_of[occurrence]
        instances.append(Instantiation(path=path, class_name=name, arguments=tuple(occurrence.arguments().items())))
        if isinstance(occurrence, LawOccurrence):
            continue
        placed = occurrence.placed
        shape = placed.shape
        for channel in shape.channels.values():
            period = placed.period(channel.name)
            net = _OpenNet(f"{path}.{channel.name}", channel.kind, channel.type, None, period, channel.span)
            attached[channel.name] = net
            nets.append(net)
        if shape not in own_uses:
            own_uses[shape] = _own_uses(shape)
        for users, keys in zip(("writers", "readers"), own_uses[shape], strict=True):
            for key in keys:
                if key in attached:
                    getattr(attached[key], users).append((path, key))
        inside: list[tuple[str, Occurrence | LawOccurrence, dict[Key, _OpenNet]]] = []
        for name, instance in shape.instances.items():
            theirs: dict[Key, _OpenNet] = {}
            leaf = instance.shape.is_submodel or instance.shape.is_external
            for element, attachment in instance.attachments.items():
                outer = attached_key(attachment)
                inner_net = attached.get(outer) if outer is not None else None
                if inner_net is None:
                    continue
                key = element_name(*element)
                if not leaf:
                    theirs[key] = inner_net
                elif instance.shape.ports[element[0]].direction == "in":
                    inner_net.readers.append((f"{path}.{name}", key))
                else:
                    inner_net.writers.append((f"{path}.{name}", key))
            inside.append((f"{path}.{name}", occurrence.children[name], theirs))
        pending.extend(reversed(inside))
    return tuple(instances), tuple(net.closed() for net in nets if net.external or net.writers or net.readers)


def _own_uses(shape: Shape) -> tuple[list[Key], list[Key]]:
    """The ports and channels that a process itself writes and reads, each once, in text order; expressions are no readers."""
    writes: dict[Key, None] = {}
    reads: dict[Key, None] = {}
    for action in [] if shape.body is None else all_actions(shape.body):
        match action:
            case ReadValue():
                reads[end_key(action.source)] = None
            case WriteValue():
                writes[end_key(action.sink)] = None
            case ChoiceAction() | InterruptOn():
                branches = action.branches if isinstance(action, ChoiceAction) else (action.branch,)
                for branch in branches:
                    if isinstance(branch.event, ReadyEvent | InputEvent):
                        reads[end_key(branch.event.source)] = None
                    elif isinstance(branch.event, OutputEvent):
                        writes[end_key(branch.event.sink)] = None
            case _:
                pass
    return list(writes), list(reads)
