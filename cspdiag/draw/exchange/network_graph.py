"""A network as a graph of networkx: everything that takes part in communications, and the channels between."""

from __future__ import annotations

import networkx

from cspdiag.base import Span
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import ArrayType, RealType, Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import (
    DriverInstance,
    Environment,
    ExternalPort,
    InstanceOf,
    Instantiation,
    LocalChannel,
    Net,
    Network,
    ProcessClass,
)

Facts = dict[str, object]


def network_graph(network: Network) -> networkx.MultiDiGraph:
    """The graph of a network; ``docs/drawing.md`` lists the attributes of nodes and edges.

    A node has the path of what it represents, in the order of the text. An edge leads from each writer of a channel to
    each reader; its key is its number in the graph.
    """
    return _Builder(network).build()


class _Builder:
    """Adds the parts of a network to a graph."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._graph = networkx.MultiDiGraph(name=network.top, source=network.source)
        self._classes = {entry.name: entry for entry in network.classes}
        self._class_of = {instance.path: self._classes[instance.class_name] for instance in network.instances}
        self._ports = {f"{network.top}.{port.name}": port for port in network.external_ports}
        self._owned: dict[str, LocalChannel] = {}
        self._declared: dict[str, tuple[str, InstanceOf]] = {}
        """The path of the process that contains an instance, and the declaration of the instance, by its path."""
        for path, entry in self._class_of.items():
            if isinstance(entry, ProcessClass):
                self._owned.update((f"{path}.{channel.name}", channel) for channel in entry.channels)
                self._declared.update((f"{path}.{inner.name}", (path, inner)) for inner in entry.instances)

    def build(self) -> networkx.MultiDiGraph:
        for instance in self._network.instances:
            self._add_instance(instance)
        for path, port in self._ports.items():
            self._graph.add_node(path, **_external_port(path, port))
        for net in self._network.nets:
            self._add_net(net)
        for environment in self._network.environments:
            self._add_environment(environment)
        return self._graph

    def _add_instance(self, instance: Instantiation) -> None:
        entry = self._class_of[instance.path]
        parent, declared = self._declared.get(instance.path, (None, None))
        types: dict[str, Type] = {parameter.name: parameter.type for parameter in entry.parameters}
        self._graph.add_node(
            instance.path,
            kind="process" if isinstance(entry, ProcessClass) else "submodel",
            name=instance.path if declared is None else declared.name,
            path=instance.path,
            parent=parent,
            definition=entry.definition,
            class_name=entry.name,
            arguments={name: value_text(value, types[name]) for name, value in instance.arguments},
            array=None if declared is None else declared.array,
            index=None if declared is None else declared.index,
            **_place(entry.span if declared is None else declared.span),
        )

    def _add_net(self, net: Net) -> None:
        port = self._ports.get(net.path)
        outside = [] if port is None else [(net.path, port.name)]
        writers = [*net.writers, *(outside if net.external == "in" else ())]
        readers = [*net.readers, *(outside if net.external == "out" else ())]
        owned = self._owned.get(net.path)
        facts = {
            "channel": net.path,
            "name": owned.name if owned else net.path.rpartition(".")[2],
            "kind": net.kind if port is None else _outside_kind(port),
            **_typed(net.type),
            **_sampled(net.sampling),
            "capacity": None if owned is None else owned.capacity,
            **_place(net.span),
        }
        for writer in writers:
            for reader in readers:
                self._connect(writer, reader, facts)

    def _connect(self, writer: tuple[str, str], reader: tuple[str, str], facts: Facts) -> None:
        key = self._graph.number_of_edges()
        self._graph.add_edge(writer[0], reader[0], key=key, **facts, source_port=writer[1], target_port=reader[1])

    def _add_environment(self, environment: Environment) -> None:
        path = environment.name
        self._graph.add_node(
            path,
            kind="environment",
            name=path,
            path=path,
            parent=None,
            definition=path,
            class_name=path,
            step=environment.step,
            **_place(environment.span),
        )
        for port in () if environment.system is None else environment.system.ports:
            self._meet(path, port.name, port.name)
        for driver in environment.drivers:
            self._add_driver(path, driver)

    def _add_driver(self, environment: str, driver: DriverInstance) -> None:
        path = f"{environment}.{driver.name}"
        self._graph.add_node(
            path,
            kind="driver",
            name=driver.name,
            path=path,
            parent=environment,
            definition=driver.definition,
            class_name=driver.definition,
            arguments={name: _plain(value) for name, value in driver.arguments},
            **_place(driver.span),
        )
        for own, outside in driver.connections:
            self._meet(path, own, outside)

    def _meet(self, path: str, own: str, name: str) -> None:
        """Connect the environment to one of the program's ports."""
        outside = f"{self._network.top}.{name}"
        port = self._ports.get(outside)
        if port is None:
            return
        facts = {
            "channel": outside,
            "name": name,
            "kind": _outside_kind(port),
            **_typed(port.type),
            **_sampled(port.sampling),
            "capacity": None,
            **_place(port.span),
        }
        if port.direction == "in":
            self._connect((path, own), (outside, name), facts)
        else:
            self._connect((outside, name), (path, own), facts)


def _external_port(path: str, port: ExternalPort) -> Facts:
    return {
        "kind": "port",
        "name": port.name,
        "path": path,
        "parent": None,
        "direction": port.direction,
        **_typed(port.type),
        **_sampled(port.sampling),
        **_place(port.span),
    }


def _sampled(sampling: Sampling | None) -> Facts:
    if sampling is None:
        return {"period": None}
    return {"period": sampling.period, **({"offset": sampling.offset} if sampling.offset else {})}


def _outside_kind(port: ExternalPort) -> str:
    """What carries the values of an external port."""
    if port.direction == "out":
        return "direct" if port.sampling is None or port.immediate else "latched"
    if port.sampling is not None:
        return "sampled"
    return "event" if port.kind == "sync" else port.kind


def _typed(type_: Type) -> Facts:
    element = type_
    while isinstance(element, ArrayType):
        element = element.element
    return {"type": str(type_), "unit": str(element.unit) if isinstance(element, RealType) else None}


def _plain(value: Value) -> str:
    return value if isinstance(value, str) else repr(value)


def _place(span: Span) -> Facts:
    return {"file": span.file, "line": span.line}
