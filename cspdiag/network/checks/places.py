"""Places of an environment: the instances of the outermost process, each in one place, and what connects the places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.network.diagnostics.environments import (
    DriverOfTwoPlaces,
    IndivisibleChannel,
    NotPlaced,
    PlacedTwice,
    PlacesNeedParallel,
    UnknownPlaced,
)
from cspdiag.network.elaborate.environment_wiring import Wiring
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.walk import parts
from cspdiag.network.shapes import InstanceShape, Key, OwnPort, RequestedKind, Shape, attached_key, element_name
from cspdiag.syntax import ast

_WHY = {
    "var": "a variable exists on one host only",
    "any": "which of several processes communicates is decided on one host only",
    "buffer": "a buffer exists on one host only",
    "overwrite": "a buffer exists on one host only",
}


@record
class _User:
    place: str
    instance: InstanceShape
    element: Key
    writes: bool

    __hash__ = object.__hash__


def check_places(
    definition: ast.EnvironmentDefinition,
    placed: Placed,
    requested: Mapping[Key, Mapping[str, RequestedKind]],
    drawn: Wiring,
    report: Report,
) -> None:
    """Reports what is wrong with the places of an environment; ``placed`` is its process in its context."""
    own = Report()
    shape = placed.shape
    place_of = _places(definition, shape, own)
    if not own.has_errors and not _is_parallel_of_instances(shape.body):
        composition = shape.definition.composition_span if isinstance(shape.definition, ast.ProcessDefinition) else None
        own.add(PlacesNeedParallel(definition.places[0].span, shape.definition.name.text, composition))
    if not own.has_errors:
        users = _users(shape, place_of)
        _check_channels(definition, placed, requested, users, own)
        _check_drivers(definition, drawn, users, own)
    for diagnostic in own.diagnostics:
        report.add(diagnostic)


def _places(definition: ast.EnvironmentDefinition, shape: Shape, report: Report) -> dict[str, str]:
    """The place of each instance, arrays of instances as a whole."""
    declared = {instance.declaration.name.text: instance for instance in shape.instances.values()}
    found: dict[str, tuple[ast.Identifier, str]] = {}
    names: dict[str, ast.Identifier] = {}
    for place in definition.places:
        if place.name.text in names:
            first = names[place.name.text].span
            report.add(PlacedTwice(place.name.span, f"the place `{place.name.text}`", first))
        names.setdefault(place.name.text, place.name)
        for instance in place.instances:
            if instance.text not in declared:
                process = shape.definition.name.text
                report.add(UnknownPlaced(instance.span, instance.text, process, tuple(declared)))
            elif instance.text in found:
                first = found[instance.text][0].span
                report.add(PlacedTwice(instance.span, f"the instance `{instance.text}`", first))
            else:
                found[instance.text] = instance, place.name.text
    for name, missing in declared.items():
        # A name that does not exist may be meant for one that seems to be missing.
        if name not in found and not report.has_errors:
            report.add(NotPlaced(definition.places[0].span, name, missing.span))
    return {name: place for name, (_, place) in found.items()}


def _is_parallel_of_instances(body: ir.CoreAction | None) -> bool:
    return (
        isinstance(body, ir.ParallelSteps)
        and not body.prioritized
        and all(isinstance(step, ir.RunInstance) or _is_parallel_of_instances(step) for step in body.steps)
    )


def _users(shape: Shape, place_of: Mapping[str, str]) -> dict[Key, list[_User]]:
    """Who uses each port and each channel of the outermost process."""
    users: dict[Key, list[_User]] = {}
    for instance in shape.instances.values():
        place = place_of[instance.declaration.name.text]
        for element, attached in instance.attachments.items():
            key = attached_key(attached)
            if key is not None:
                writes = instance.shape.ports[element[0]].direction == "out"
                users.setdefault(key, []).append(_User(place, instance, element_name(*element), writes))
    return users


def _check_channels(
    definition: ast.EnvironmentDefinition,
    placed: Placed,
    requested: Mapping[Key, Mapping[str, RequestedKind]],
    users: Mapping[Key, list[_User]],
    report: Report,
) -> None:
    for key, its_users in users.items():
        places = tuple(dict.fromkeys(user.place for user in its_users))
        if len(places) < 2:
            continue
        channel = placed.shape.channels.get(key)
        kind = placed.facts[key][0]
        if channel is None and "any" in requested.get(key, {}):
            kind = "any"
        why = _WHY.get(kind)
        writers = (user for user in its_users if user.writes)
        if why is None and any(_has_output_guard(user.instance.shape, user.element) for user in writers):
            why = "an output guard needs both sides on one host"
        if why is not None:
            span = placed.shape.port_spans[key] if channel is None else channel.span
            where = definition.places[0].span
            report.add(IndivisibleChannel(where, key, why, (places[0], places[1]), span))


def _has_output_guard(shape: Shape, port: Key) -> bool:
    """Whether an alternative or an interrupt of a process, or of one inside it, may write to a port of it."""
    guards = [part for part in parts(shape.body) if isinstance(part, ir.OutputEvent)] if shape.body is not None else []
    written = (guard.sink for guard in guards if isinstance(guard.sink, ir.PortEnd))
    if any(element_name(sink.port, sink.index) == port for sink in written):
        return True
    return any(_has_output_guard(inside.shape, inner) for inside, inner in _inside(shape, port))


def _inside(shape: Shape, port: Key) -> Iterator[tuple[InstanceShape, Key]]:
    """The instances in a process that use one of its ports, each with its own port."""
    for instance in shape.instances.values():
        for element, attached in instance.attachments.items():
            if isinstance(attached.target, OwnPort) and attached.target.key == port:
                yield instance, element_name(*element)


def _check_drivers(
    definition: ast.EnvironmentDefinition, drawn: Wiring, users: Mapping[Key, list[_User]], report: Report
) -> None:
    for member in drawn.members.values():
        if not member.is_driver:
            continue
        places: dict[str, None] = {}
        for wire in drawn.wires:
            for end, other in ((wire.source, wire.sink), (wire.sink, wire.source)):
                if end.member == member.name and not other.member:
                    places.update((user.place, None) for user in users.get(other.port, ()))
        if len(places) > 1:
            first, second, *_ = places
            report.add(DriverOfTwoPlaces(member.declaration.name.span, member.name, (first, second)))
