"""Makes one class for each combination of media that its ports are connected to, and records what targets need to know.

After it each port states its media, each channel whether it is guarded, each alternative has a name, and each class the
order in which its parts are created.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import TypeAlias, assert_never

from cspdiag.base.record import replaced
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import (
    Attachment,
    ConstantEnd,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    Medium,
    MediumKind,
    Network,
    Port,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.optimize.changes import changed, in_sequence, mapped, rebuilt, with_inner_actions
from cspdiag.optimize.creation import creation_order
from cspdiag.optimize.guarded_places import Guards, PortOrChannel, guards_by_class, port_or_channel
from cspdiag.optimize.reachable import reachable

Media: TypeAlias = "tuple[tuple[Medium, ...], ...]"
"""For each port of a class the media of the port, or of its elements."""


def specialize(network: Network) -> Network:
    """The network with the media of all ports known; a class that is connected in different ways is cloned (``Cell``,
    ``Cell2``).
    """
    classes = tuple(entry if isinstance(entry, SubmodelClass) else _prepared(entry) for entry in network.classes)
    return _Specialization(replaced(network, classes=classes)).result()


def _prepared(entry: ProcessClass) -> ProcessClass:
    """The class without alternatives that have only one choice, and with names for the others."""
    return entry if entry.body is None else replaced(entry, body=named_choices(rebuilt(entry.body, _without_choice)))


def _without_choice(action: ir.Action) -> ir.Action:
    """The communication that an alternative with a single guard amounts to."""
    match action:
        case ir.Choice(branches=(ir.Branch(condition=None) as branch,)) if not isinstance(branch.event, ir.ReadyEvent):
            return in_sequence([*_communication_of(branch), branch.body], action)
        case _:  # Any other action is unchanged.
            return action


def _communication_of(branch: ir.Branch) -> list[ir.Action]:
    event = branch.event
    match event:
        case ir.InputEvent():
            return [ir.ReadValue(span=event.span, source=event.source, target=event.target)]
        case ir.OutputEvent():
            return [ir.WriteValue(span=event.span, sink=event.sink, value=event.value)]
        case ir.AfterEvent():
            return [ir.WaitStep(span=event.span, duration=event.duration)]
        case ir.SkipEvent():
            return []
        case ir.ReadyEvent():
            raise AssertionError("a ready guard needs an alternative")


def named_choices(body: ir.Action) -> ir.Action:
    """The composition with its alternatives named in text order: ``choice``, ``choice_2``."""
    number = 0

    def named(action: ir.Action) -> ir.Action:
        nonlocal number
        if isinstance(action, ir.Choice):
            number += 1
            action = replaced(action, name="choice" if number == 1 else f"choice_{number}")
        return with_inner_actions(action, named)

    return named(body)


class _Specialization:
    """Proceeds from the outermost process inwards and collects the media with which each class is used."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.classes = {entry.name: entry for entry in network.classes}
        self.guards = guards_by_class(network)
        self.names: dict[tuple[str, Media], str] = {}
        self.clones: dict[str, list[ProcessClass]] = {entry.name: [] for entry in network.classes}
        self._pending: deque[tuple[ProcessClass, Media]] = deque()
        self._counts: dict[str, int] = {}
        self._taken = {
            *self.classes,
            *(constant.name for constant in network.constants),
            *(enum.name for enum in network.enums),
            *(struct.name for struct in network.structs),
            *network.exceptions,
        }

    def result(self) -> Network:
        """The network of clones."""
        network = self.network
        top = self.classes[network.top]
        assert isinstance(top, ProcessClass)
        self._name(top, self._outside(top))
        while self._pending:
            self._specialize(*self._pending.popleft())
        submodels = {entry.name: entry for entry in network.classes if isinstance(entry, SubmodelClass)}
        classes: list[ProcessClass | SubmodelClass] = []
        for entry in network.classes:
            if isinstance(entry, SubmodelClass):
                classes.append(entry)
            for clone in self.clones[entry.name]:
                classes.append(replaced(clone, creation=creation_order(clone, submodels)))
        return reachable(replaced(network, classes=tuple(classes)))

    def _outside(self, top: ProcessClass) -> Media:
        """The media of the ports of the outermost process."""
        kinds = {(port.name.partition("[")[0], port.index): port.medium for port in self.network.external_ports}
        guards = self.guards[top.name]
        return tuple(tuple(_medium(kinds[place], place, guards) for place in _elements(port)) for port in top.ports)

    def _name(self, entry: ProcessClass, media: Media) -> str:
        """The name of a clone; the first one keeps the name of the class."""
        key = (entry.name, media)
        name = self.names.get(key)
        if name is None:
            number = self._counts[entry.name] = self._counts.get(entry.name, 0) + 1
            name = entry.name
            while number > 1 and name in self._taken:
                name = f"{entry.name}{number}"
                number += 1
            self._taken.add(name)
            self.names[key] = name
            self._pending.append((entry, media))
        return name

    def _specialize(self, entry: ProcessClass, media: Media) -> None:
        guards = self.guards[entry.name]
        channels = mapped(entry.channels, lambda channel: _guarded(channel, guards))
        medium_of: dict[PortOrChannel, Medium] = {}
        for port, elements in zip(entry.ports, media, strict=True):
            medium_of.update(zip(_elements(port), elements, strict=True))
        shared: dict[Medium, Medium] = {}
        for channel in channels:
            medium = Medium(channel.kind, channel.guarded_reads, channel.guarded_writes)
            medium_of[channel.name] = shared.setdefault(medium, medium)
        clone = replaced(
            entry,
            name=self.names[entry.name, media],
            ports=tuple(replaced(port, media=m) for port, m in zip(entry.ports, media, strict=True)),
            channels=channels,
            instances=mapped(entry.instances, lambda instance: self._instance(instance, medium_of)),
        )
        self.clones[entry.name].append(clone)

    def _instance(self, instance: InstanceOf, medium_of: Mapping[PortOrChannel, Medium]) -> InstanceOf:
        inner = self.classes[instance.class_name]
        if isinstance(inner, SubmodelClass):
            return instance
        attached = {(c.port, c.index): _attached(c.attachment, medium_of) for c in instance.connections}
        media = tuple([tuple([attached[place] for place in _elements(port)]) for port in inner.ports])
        return changed(instance, class_name=self._name(inner, media))


def _elements(port: Port) -> list[tuple[str, int | None]]:
    return [(port.name, None)] if port.size is None else [(port.name, index) for index in range(port.size)]


def _medium(kind: MediumKind, place: PortOrChannel, guards: Guards) -> Medium:
    return Medium(kind, place in guards.reads, place in guards.writes)


def _guarded(channel: LocalChannel, guards: Guards) -> LocalChannel:
    reads, writes = channel.name in guards.reads, channel.name in guards.writes
    return changed(channel, guarded_reads=reads, guarded_writes=writes)


def _attached(attachment: Attachment, medium_of: Mapping[PortOrChannel, Medium]) -> Medium:
    match attachment:
        case ConstantEnd():
            return _CONSTANT
        case DiscardEnd():
            return _DISCARD
        case ir.PortEnd() | ir.ChannelEnd():
            return medium_of[port_or_channel(attachment)]
        case _:
            assert_never(attachment)


_CONSTANT = Medium("constant")
_DISCARD = Medium("discard")
