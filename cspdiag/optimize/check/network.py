"""Checks whether a network is valid: every name is declared, types agree, steps have source places, and no step is
there that only a later pass makes.

With ``--debug-passes`` the network is checked after each pass, so a defect is reported for the pass that made it and
not for generated code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import assert_never

from cspdiag.base.errors import CspdiagError
from cspdiag.model.types import DOUBLE, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import TunableValue
from cspdiag.network.ir.network import (
    ConstantEnd,
    DiscardEnd,
    InstanceOf,
    Network,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.check.composition import CompositionCheck
from cspdiag.optimize.check.expressions import Names, agrees, expression_problems, is_value_of, types_of

MADE_BY: dict[type[ir.MadeAction], str] = {
    ir.ReadInputs: "inline_laws",
    ir.WriteOutputs: "inline_laws",
    ir.RunLaw: "inline_laws",
    ir.ResetStates: "inline_laws",
    ir.ProcessScope: "flatten",
    ir.ReportCommunication: "fuse",
}
"""The pass that makes each of the steps that are not in a program text."""

Class = ProcessClass | SubmodelClass


class BrokenNetworkError(CspdiagError, ValueError):
    """A pass has made an invalid network; ``problems`` are sentences, ``after`` is the pass."""

    def __init__(self, problems: tuple[str, ...], after: str) -> None:
        super().__init__(f"the network is broken after {after}: {'; '.join(problems)}")
        self.problems = problems


def require_valid(network: Network, passes: Collection[str] = ()) -> None:
    """Raise BrokenNetworkError unless the network is valid after ``passes``, in their order."""
    problems = tuple(dict.fromkeys(network_problems(network, passes)))
    if problems:
        raise BrokenNetworkError(problems, [*passes][-1] if passes else "lowering")


def network_problems(network: Network, passes: Collection[str]) -> Iterator[str]:
    """The problems of a network after these passes."""
    classes: dict[str, Class] = {}
    exceptions = frozenset(network.exceptions)
    for entry in network.classes:
        found = _wrong_in_submodel(entry) if isinstance(entry, SubmodelClass) else ()
        if isinstance(entry, ProcessClass):
            found = _wrong_in_process(entry, classes, exceptions, passes)
        yield from (f"{entry.name}: {problem}" for problem in found)
        yield from _repeated("class", [entry.name, *classes.keys() & {entry.name}])
        classes[entry.name] = entry
    if not isinstance(classes.get(network.top), ProcessClass):
        yield f"the outermost process `{network.top}` is not a process"
        return
    stands_for = {name for name, _ in network.tunable}
    before = [(name, value) for path, name, value in _listed(network) if path == network.top and name in stands_for]
    yield from _wrong_arguments(network.top, classes[network.top], (*network.arguments, *before))
    yield from _wrong_instances(network, classes)
    yield from _wrong_parameters(network, classes[network.top])
    parameters = {parameter.name: parameter.type for parameter in network.parameters}
    for environment in network.environments:
        if environment.system is not None:
            yield from (
                f"{environment.name}: {problem}" for problem in _wrong_in_submodel(environment.system, parameters)
            )


def _wrong_instances(network: Network, classes: Mapping[str, Class]) -> Iterator[str]:
    """The listed instances must be those of the tree that the classes define."""
    listed = {item.path: item for item in network.instances}
    pending = [(network.top, classes[network.top])]
    there = {network.top}
    while pending:
        path, entry = pending.pop()
        item = listed.get(path)
        if item is None and path != network.top:
            yield f"the instance `{path}` is not listed"
        elif item is not None and item.class_name != entry.name:
            yield f"the instance `{path}` is listed as one of `{item.class_name}`, and is one of `{entry.name}`"
        elif item is not None:
            yield from _wrong_arguments(path, entry, item.arguments)
        if isinstance(entry, ProcessClass):
            for instance in entry.instances:
                if instance.class_name in classes:
                    there.add(f"{path}.{instance.name}")
                    pending.append((f"{path}.{instance.name}", classes[instance.class_name]))
    yield from (f"the instance `{path}` is listed but does not exist" for path in listed if path not in there)


def _listed(network: Network) -> Iterator[tuple[str, str, object]]:
    for item in network.instances:
        yield from ((item.path, name, value) for name, value in item.arguments)


def _wrong_parameters(network: Network, top: Class) -> Iterator[str]:
    """The parameters of the program, each computed from those before it, and those that the outermost process has."""
    known: dict[str, Type] = {}
    for parameter in network.parameters:
        names = Names(parameters={}, variables={}, signals={}, tunable=known)
        if parameter.follows is not None:
            yield from expression_problems(parameter.follows, names, parameter.type)
        if not is_value_of(parameter.value, parameter.type):
            yield f"`{parameter.name}` begins with {parameter.value}, which is not of type {parameter.type}"
        known[parameter.name] = parameter.type
    own = types_of(top.parameters, tunable=True)
    if own.keys() != dict(network.tunable).keys():
        yield f"the tunable parameters of `{top.name}` are not those that the program gives it"
    for name, parameter_name in network.tunable:
        if parameter_name not in known:
            yield f"`{top.name}` has a parameter that the program does not have, `{parameter_name}`"
        elif name in own and not agrees(own[name], known[parameter_name]):
            yield f"`{name}` is {own[name]} and refers to `{parameter_name}`, which is {known[parameter_name]}"


def _wrong_arguments(path: str, entry: Class, arguments: Iterable[tuple[str, object]]) -> Iterator[str]:
    kinds = {parameter.name: parameter.type for parameter in entry.parameters}
    given = dict(arguments)
    for name in kinds.keys() ^ given.keys():
        yield f"`{path}` and `{entry.name}` disagree about a parameter `{name}`"
    for name in kinds.keys() & given.keys():
        if not is_value_of(given[name], kinds[name]):  # type: ignore[arg-type]
            yield f"`{path}` gives `{name}` the value {given[name]}, which is not of type {kinds[name]}"


def _wrong_in_process(
    entry: ProcessClass, inside: Mapping[str, Class], exceptions: frozenset[str], passes: Collection[str]
) -> Iterator[str]:
    yield from _repeated(
        "port or channel", [*(port.name for port in entry.ports), *(channel.name for channel in entry.channels)]
    )
    yield from _repeated("instance", [instance.name for instance in entry.instances])
    yield from _repeated("parameter", [parameter.name for parameter in entry.parameters])
    yield from _repeated("state or constant", [item.name for item in (*entry.states, *entry.constants)])
    for part in parts(entry.body):
        if isinstance(part, ir.MadeAction) and MADE_BY[type(part)] not in passes:
            yield f"{type(part).__name__} is there before the pass `{MADE_BY[type(part)]}`"
    composition = CompositionCheck(entry, exceptions)
    yield from composition.problems()
    for instance in entry.instances:
        if instance.class_name not in inside:
            yield f"the class `{instance.class_name}` of `{instance.name}` is not before it"
        else:
            yield from _wrong_in_instance(instance, inside[instance.class_name], composition)
    if "specialize" in passes:
        yield from _wrong_after_specialize(entry)


def _wrong_after_specialize(entry: ProcessClass) -> Iterator[str]:
    for port in entry.ports:
        if len(port.media) != (1 if port.size is None else port.size):
            yield f"the port `{port.name}` does not say what it is connected to"
    if any(isinstance(part, ir.Choice) and not part.name for part in parts(entry.body)):
        yield "an alternative has no name"


def _wrong_in_instance(instance: InstanceOf, entry: Class, around: CompositionCheck) -> Iterator[str]:
    kinds = {parameter.name: parameter.type for parameter in entry.parameters}
    if kinds.keys() != dict(instance.arguments).keys():
        yield f"the arguments of `{instance.name}` are not the parameters of `{entry.name}`"
    references = {parameter.name for parameter in entry.parameters if parameter.tunable}
    for name, value in instance.arguments:
        yield from expression_problems(value, around.names, kinds.get(name))
        if (name in references) != isinstance(value, TunableValue):
            yield f"the argument `{name}` of `{instance.name}` is {'no' if name in references else 'a'} reference"
    ports = {port.name: port for port in entry.ports}
    wanted = {(p.name, i) for p in entry.ports for i in ([None] if p.size is None else range(p.size))}
    yield from _repeated("connection", [f"{instance.name}.{c.port}[{c.index}]" for c in instance.connections])
    if wanted != {(connection.port, connection.index) for connection in instance.connections}:
        yield f"the connections of `{instance.name}` are not the ports of `{entry.name}`"
    for connection in instance.connections:
        port, attached = ports.get(connection.port), connection.attachment
        match attached:
            case ConstantEnd():
                yield from expression_problems(attached.value, around.names, port.type if port else None)
            case PortEnd() | ChannelEnd():
                yield from around.end(attached, port.direction if port else None)
                kind = around.type_of(attached)
                if port is not None and kind is not None and not agrees(kind, port.type):
                    yield f"`{instance.name}.{port.name}` is {port.type} and connected to {kind}"
            case DiscardEnd():
                pass
            case _:
                assert_never(attached)


def _wrong_in_submodel(entry: SubmodelClass, program: Mapping[str, Type] | None = None) -> Iterator[str]:
    """The problems of a control law, or of the system of an environment, which has the parameters of the ``program``
    and the present time.
    """
    signals: dict[str, Type] = {constant.name: constant.type for constant in entry.constants}
    signals.update((state.name, state.type) for state in entry.states)
    signals.update((port.name, port.type) for port in entry.ports)
    for equation in entry.equations:
        if isinstance(equation, ExternalCall):
            signals.update((name, kind) for _, name, kind in equation.outputs)
        else:
            signals[equation.name] = equation.type
    names = Names(
        parameters=types_of(entry.parameters, tunable=False),
        variables={},
        signals=signals,
        tunable=types_of(entry.parameters, tunable=True) if program is None else program,
        time=None if program is None else DOUBLE,
    )
    states = {state.name: state.type for state in entry.states}
    for item in (*entry.constants, *entry.equations, *entry.derivative_equations):
        if not isinstance(item, ExternalCall):
            yield from expression_problems(item.value, names, item.type)
    for state in entry.states:
        yield from expression_problems(state.initial, names, state.type)
    for name, value in (*entry.next_values, *entry.derivatives):
        if name not in states:
            yield f"there is no state `{name}`"
        yield from expression_problems(value, names)


def _repeated(what: str, names: Iterable[str]) -> Iterator[str]:
    yield from (f"there are {n} declarations of the {what} `{name}`" for name, n in Counter(names).items() if n > 1)
