"""The declarations of the struct of a process class, and of the struct through which it receives its ports."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

from cspdiag.codegen.c.process.struct.members import Members, StructMember
from cspdiag.codegen.c.process.struct.port_layout import elements
from cspdiag.codegen.c.text.media import READING_ENDS, access_of, channel_type, port_type
from cspdiag.network.ir.actions import PortEnd
from cspdiag.network.ir.network import InstanceOf, LocalChannel, Port

T = TypeVar("T", LocalChannel, InstanceOf)


def port_members(members: Members) -> list[StructMember]:
    """The members of the struct through which a process receives its ports."""
    found: list[StructMember] = []
    for port in members.process.ports:
        whole = port.size is not None and members.layout.uniform[port.name]
        for index in elements(port)[:1] if whole else elements(port):
            access = access_of(port.media[index or 0])
            type_ = port_type(access, members.types.type_name(port.type), writes=port.direction == "out")
            if type_ is not None:
                name = f"{members.names[port.name]}[{port.size}]" if whole else members.layout.member(port, index)
                found.append(StructMember(f"{type_}{name}"))
        found += _flag_pointers(members, port, elements(port))
    return found


def declared(members: Members) -> list[StructMember]:
    """The members for parameters, ports, channels and instances, in this order."""
    process, found = members.process, [StructMember("csp_process process")]
    parameters = {item.name: item for item in process.parameters}
    if members.has_samples:
        found.append(StructMember("csp_ends samples"))
    found += [StructMember(f"csp_ends {name}") for name in members.scope_samples.values()]
    docs = {item.name: item.doc for item in (*process.parameters, *process.ports)}
    for name in members.stored_parameters():
        found.append(StructMember(members.types.parameter(parameters[name], members.parameters[name]), docs[name]))
    found += _port_declarations(members)
    found += _channel_declarations(members)
    found += _signal_declarations(members)
    found += _instance_declarations(members)
    return found


def _signal_declarations(members: Members) -> Iterator[StructMember]:
    docs = {item.name: item.doc for item in (*members.process.constants, *members.process.states)}
    for name, member in members.signal_members.items():
        yield StructMember(f"{members.types.type_name(members.signal_types[name])} {member}", docs.get(name))


def _port_declarations(members: Members) -> Iterator[StructMember]:
    done: set[str] = set()
    for port, index in members.used_ports():
        access = access_of(port.media[index or 0])
        if port.direction == "in" and access in READING_ENDS:
            continue
        type_ = port_type(access, members.types.type_name(port.type), writes=port.direction == "out")
        name = str(members.layout.member(port, index))
        if index is not None and members.layout.uniform[port.name]:
            name = f"{members.names[port.name]}[{port.size}]"
        if type_ is not None and name not in done:
            done.add(name)
            yield StructMember(f"{type_}{name}", port.doc)
        yield from _flag_pointers(members, port, [index])
    yield from _end_declarations(members)


def _flag_pointers(members: Members, port: Port, indexes: Sequence[int | None]) -> list[StructMember]:
    """Pointers to the flags whether the variables that are connected to a port were written."""
    constant = "const " if port.direction == "in" else ""
    flagged = [i for i in indexes if members.unwritten.has_port(members.process.name, port.name, i)]
    names = (members.layout.written(port, index) for index in flagged)
    return [StructMember(f"{constant}csp_written *{name}") for name in names]


def _end_declarations(members: Members) -> Iterator[StructMember]:
    done: set[str] = set()
    for end in members.created:
        access = members.access(end)
        if access not in READING_ENDS:
            continue
        base, size, doc = members.end_name(end), "", None
        if isinstance(end, PortEnd):
            port = members.ports[end.port]
            doc = port.doc
            if end.index is not None and members.layout.uniform[end.port]:
                size = f"[{port.size}]"
            elif end.index is not None:
                base = f"{base}_{end.index}"
        if base in done:
            continue
        done.add(base)
        if access == "event":
            yield StructMember(f"csp_event_end *{base}{size}", doc)
            yield StructMember(f"csp_event_end {members.latch_name(base)}{size}", "if it has one of its own")
        else:
            yield StructMember(f"{READING_ENDS[access]} {base}{size}", doc)


def _channel_declarations(members: Members) -> Iterator[StructMember]:
    for channel, count in _grouped(members, members.process.channels):
        name, access = members.plain(channel.name), access_of(channel)
        type_name = members.types.type_name(channel.type)
        yield StructMember(f"{channel_type(access, type_name)} {name}{count}", channel.doc)
        if channel.name in members.unwritten.variables[members.process.name]:
            yield StructMember(f"csp_written {members.names[f'{name} written']}{count}")
        if access == "buffer":
            yield StructMember(f"{type_name} {members.storage_name(channel.name)}{count}[{channel.capacity}]")


def _instance_declarations(members: Members) -> Iterator[StructMember]:
    for instance, count in _grouped(members, members.process.instances):
        struct = members.types.names.classes[instance.class_name]
        yield StructMember(f"struct {struct} {members.plain(instance.name)}{count}", instance.doc)


def _grouped(members: Members, items: Sequence[T]) -> Iterator[tuple[T, str]]:
    done: set[str] = set()
    for item in members.with_arrays_once(items):
        base = members.plain(item.name)
        if base not in done:
            done.add(base)
            size = members.arrays.size(item.name)
            yield item, "" if size is None else f"[{size}]"
