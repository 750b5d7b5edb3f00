"""The values that the inputs of a law have from the beginning."""

from __future__ import annotations

from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ConstantEnd, CoreNetwork, ProcessClass
from cspdiag.network.shapes import element_name


def initial_inputs(network: CoreNetwork, path: str) -> dict[str, Value]:
    """The initial values of the inputs of a law: defaults, and initial values of variables of the enclosing process."""
    above, _, name = path.rpartition(".")
    arguments = {instance.path: dict(instance.arguments) for instance in network.instances}.get(above, {})
    owner = next((entry for entry in network.instances if entry.path == above), None)
    process = None if owner is None else network.class_named(owner.class_name)
    if not isinstance(process, ProcessClass):
        return {}
    variables = {channel.name: channel.initial for channel in process.channels if channel.kind == "var"}
    declared = next(instance for instance in process.instances if instance.name == name)
    found: dict[str, Value] = {}
    for connection in declared.connections:
        attached = connection.attachment
        first = attached.value if isinstance(attached, ConstantEnd) else None
        if isinstance(attached, ir.ChannelEnd):
            first = variables.get(attached.channel)
        value = None if first is None else constant_value(first, lambda part: arguments.get(part.name))
        if value is not None:
            found[element_name(connection.port, connection.index)] = value
    return found
