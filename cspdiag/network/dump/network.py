"""The network as text, for ``--emit network`` and for the tests of lowering.

Everything that the network says and nothing else; the same network always gives the same text.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import assert_never

from cspdiag.base.render.snippet import on_one_line
from cspdiag.model.constants.durations import duration
from cspdiag.model.types import Type
from cspdiag.network.dump.action import action_lines, end_text
from cspdiag.network.dump.expression import expression_text, value_text
from cspdiag.network.dump.submodel import doc_lines, external_text, guards_text, memory_lines, port_text, submodel_body
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import (
    Attachment,
    ChannelKind,
    ClassParameter,
    ConstantEnd,
    CreatedChoice,
    CreatedInstance,
    DiscardEnd,
    Environment,
    ExternalPort,
    InstanceOf,
    LocalChannel,
    Net,
    Network,
    ProcessClass,
    SubmodelClass,
)


def dump(network: Network) -> str:
    """The listing of a network: vocabulary, classes, external ports, environments, instances, nets."""
    return "\n".join(_lines(network)) + "\n"


def _lines(network: Network) -> Iterator[str]:
    classes = {entry.name: entry for entry in network.classes}
    yield f"network {network.name} from {on_one_line(network.source)}"
    yield f"top {network.top}{_values(classes[network.top].parameters, network.arguments)}"
    yield from _vocabulary(network)
    for entry in network.classes:
        yield ""
        yield from _class(entry)
    if network.external_ports:
        yield ""
        yield "external ports {"
        yield from _indented(map(_external, network.external_ports))
        yield "}"
    for environment in network.environments:
        yield ""
        yield from _environment(environment)
    yield ""
    yield "instances {"
    for instance in network.instances:
        values = _values(classes[instance.class_name].parameters, instance.arguments)
        yield f"  {instance.path} : {instance.class_name}{values}"
    yield "}"
    if network.nets:
        yield ""
        yield "nets {"
        yield from _indented(map(_net, network.nets))
        yield "}"


def _indented(lines: Iterable[str]) -> Iterator[str]:
    return (f"  {line}" for line in lines)


def _vocabulary(network: Network) -> Iterator[str]:
    for constant in network.constants:
        yield f"const {constant.name} : {constant.type} = {value_text(constant.value, constant.type)}"
    for parameter in network.parameters:
        if parameter.follows is None:
            text = value_text(parameter.value, parameter.type)
            yield f"parameter {parameter.name} : {parameter.type} = {text}"
        else:
            yield f"const {parameter.name} : {parameter.type} follows {expression_text(parameter.follows)}"
    for enum in network.enums:
        yield f"enum {enum.name} {{ {', '.join(enum.literals)} }}"
    for struct in network.structs:
        fields = ", ".join(f"{name} : {kind}" for name, kind in struct.fields)
        yield f"struct {struct.name} {{ {fields} }}"
    for exception in network.exceptions:
        yield f"exception {exception}"


def _class(entry: ProcessClass | SubmodelClass) -> Iterator[str]:
    kind = "process" if isinstance(entry, ProcessClass) else "submodel"
    yield from doc_lines(entry.doc)
    definition = "" if entry.definition == entry.name else f" of {entry.definition}"
    external = "" if entry.external is None else f" {external_text(entry.external)}"
    wcet = "" if entry.wcet is None else f" wcet {duration(entry.wcet)}"
    yield f"{kind} {entry.name}{definition}{_parameters(entry.parameters)}{external}{wcet} {{"
    yield from _indented(_process_body(entry) if isinstance(entry, ProcessClass) else submodel_body(entry))
    yield f"}} at {on_one_line(entry.span)}"


def _parameters(parameters: tuple[ClassParameter, ...]) -> str:
    if not parameters:
        return ""
    texts = (f"{'tunable ' if p.tunable else 'derived ' if p.derived else ''}{p.name}: {p.type}" for p in parameters)
    return f"({', '.join(texts)})"


def _values(parameters: tuple[ClassParameter, ...], values: tuple[tuple[str, Value], ...]) -> str:
    if not values:
        return ""
    types: dict[str, Type] = {parameter.name: parameter.type for parameter in parameters}
    return f"({', '.join(f'{name} = {value_text(value, types[name])}' for name, value in values)})"


def _process_body(entry: ProcessClass) -> Iterator[str]:
    for port in entry.ports:
        yield port_text(port)
    for channel in entry.channels:
        yield _channel(channel)
    yield from memory_lines(entry)
    for instance in entry.instances:
        yield from _instance(instance)
    if entry.creation:
        yield f"created in the order {', '.join(map(_created, entry.creation))}"
    if entry.body is not None:
        yield "composition"
        yield from _indented(action_lines(entry.body))


def _created(part: End | CreatedInstance | CreatedChoice) -> str:
    match part:
        case CreatedInstance():
            return part.instance
        case CreatedChoice():
            return part.choice
        case PortEnd() | ChannelEnd():
            return end_text(part)
        case _:
            assert_never(part)


def _kind(kind: ChannelKind, capacity: int | None) -> str:
    return kind if capacity is None else f"{kind} {capacity}"


def _channel(channel: LocalChannel) -> str:
    initial = "" if channel.initial is None else f" = {expression_text(channel.initial)}"
    ends = "" if channel.ends == 1 else f" to {channel.ends} ends"
    return (
        f"{_kind(channel.kind, channel.capacity)} {channel.name} : {channel.type}{initial}{ends}{guards_text(channel)}"
    )


def _instance(instance: InstanceOf) -> Iterator[str]:
    arguments = ", ".join(f"{name} = {expression_text(value)}" for name, value in instance.arguments)
    yield f"{instance.name} : {instance.class_name}{f'({arguments})' if arguments else ''}"
    for connection in instance.connections:
        index = "" if connection.index is None else f"[{connection.index}]"
        yield f"  {connection.port}{index} = {_attachment(connection.attachment)}"


def _attachment(attachment: Attachment) -> str:
    match attachment:
        case ConstantEnd():
            return f"constant {expression_text(attachment.value)}"
        case DiscardEnd():
            return "_"
        case PortEnd():
            return f"port {end_text(attachment)}"
        case ChannelEnd():
            return f"channel {end_text(attachment)}"
        case _:
            assert_never(attachment)


def _external(port: ExternalPort) -> str:
    samples = "event" if port.sampling is None else f"@ {port.sampling}"
    parts = [f"{port.direction} {port.name} : {port.type} {samples}"]
    if port.immediate:
        parts.append("immediate")
    if port.safe is not None:
        parts.append(f"safe {value_text(port.safe, port.type)}")
    if port.default is not None:
        parts.append(f"default {value_text(port.default, port.type)}")
    if port.kind != "sync":
        parts.append(port.kind)
    return " ".join(parts)


def _environment(environment: Environment) -> Iterator[str]:
    yield from doc_lines(environment.doc)
    yield f"environment {environment.name} step {duration(environment.step)} on miss {environment.on_miss} {{"
    for name, instances in environment.places:
        yield f"  place {name} : {', '.join(instances)}"
    for driver in environment.drivers:
        arguments = ", ".join(f"{name} = {value!r}" for name, value in driver.arguments)
        called = f"{driver.definition}({arguments})" if arguments else driver.definition
        yield f"  driver {driver.name} : {called} {external_text(driver.external)}"
        for port, program_port in driver.connections:
            yield f"    {port} = {program_port}"
    if environment.system is not None:
        yield from _indented(submodel_body(environment.system))
    yield f"}} at {on_one_line(environment.span)}"


def _net(net: Net) -> str:
    writers = ", ".join(f"{path}.{port}" for path, port in net.writers) or "nobody"
    readers = ", ".join(f"{path}.{port}" for path, port in net.readers) or "nobody"
    if net.external == "in":
        writers = "the environment"
    elif net.external == "out":
        readers = "the environment"
    samples = "" if net.sampling is None else f" @ {net.sampling}"
    external = "" if net.external is None else " sampled" if net.sampling is not None else " event"
    kind = "" if net.external and net.kind == "sync" else f" {net.kind}"
    return f"{net.path} : {net.type}{external}{kind}{samples}: {writers} -> {readers}"
