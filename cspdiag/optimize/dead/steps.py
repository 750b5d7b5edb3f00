"""Dead code elimination: steps that are never reached, handlers of exceptions that are never raised, and everything
that is no longer used.

Computations that may fault are kept, even if their values are not used, and so are the reading ends of a ``broadcast``:
its writer waits for them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from cspdiag.base.record import replaced
from cspdiag.network.checks.unwritten import may_be_unwritten
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Compute, Instruction
from cspdiag.network.flow.ends import every_step_is_reached, may_end
from cspdiag.network.flow.raised import NO_EXCEPTIONS, Exceptions, exceptions_of
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import ParameterValue, TunableValue, VariableValue
from cspdiag.network.ir.network import (
    CreatedChoice,
    CreatedInstance,
    Instantiation,
    Network,
    Port,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.walk import all_actions, parts
from cspdiag.optimize.changes import changed, in_sequence, mapped
from cspdiag.optimize.dead.broadcasts import ends_at, possible_broadcasts
from cspdiag.optimize.dead.values import without_dead_values
from cspdiag.optimize.reachable import reachable

Class: TypeAlias = "ProcessClass | SubmodelClass"
Raised: TypeAlias = "dict[str, Exceptions]"
"""The declared exceptions that an instance of each class may raise."""


def remove_dead_parts(network: Network) -> Network:
    """The network without steps, handlers, equations, states, variables, ports, channels, instances, parameters and
    classes that have no effect.
    """
    raised: Raised = {}
    unwritten = may_be_unwritten(network)
    results: dict[str, Class] = {}
    for entry in network.classes:
        if isinstance(entry, ProcessClass) and entry.body is not None:
            reached = _reached(entry, raised)
            assert reached.body is not None
            raised[entry.name] = _Raising(reached, raised).by(reached.body)
            live = _without_unused_instances(without_dead_values(reached, unwritten[entry.name]), results)
            results[entry.name] = _without_unused_parts(live, results, keep_ports=entry.name == network.top)
        else:
            raised[entry.name] = None if entry.external is not None else frozenset()
            results[entry.name] = entry
    return _without_arguments(reachable(replaced(network, classes=tuple(results.values()))))


def _reached(entry: ProcessClass, raised: Raised) -> ProcessClass:
    """The class without steps that are never reached and handlers of exceptions that are never raised."""
    broadcasts = possible_broadcasts(entry)
    raising = _Raising(entry, raised)
    assert entry.body is not None
    is_fully_reached = every_step_is_reached(entry.body)

    def change(item: Any) -> Any:
        nonlocal is_fully_reached
        match item:
            case ir.SequentialSteps() if not is_fully_reached:
                return _up_to_endless_step(item, broadcasts)
            case ir.CatchException() if not raising.may(item.body, item.exception):
                is_fully_reached = False
                return item if ends_at(item.handler, broadcasts) else item.body
            case _:  # Any other part is unchanged.
                return item

    return replaced(entry, body=rewritten(entry.body, change))


def _up_to_endless_step(sequence: ir.SequentialSteps, broadcasts: frozenset[str]) -> ir.Action:
    for number, step in enumerate(sequence.steps[:-1], start=1):
        if not may_end(step):
            rest = sequence.steps[number:]
            if any(isinstance(part, ir.RunInstance) for part in parts(rest)) or ends_at(rest, broadcasts):
                break
            return in_sequence(sequence.steps[:number], sequence)
    return sequence


class _Raising:
    """The exceptions that compositions of a class may raise."""

    def __init__(self, entry: ProcessClass, raised: Raised) -> None:
        self._classes = {instance.name: instance.class_name for instance in entry.instances}
        self._raised = raised
        self._sampled = {p.name for p in entry.ports if not p.media or any(m.kind == "sampled" for m in p.media)}

    def by(self, body: ir.Action) -> Exceptions:
        """The declared exceptions that may leave a composition, including those of the instances that it runs."""
        return exceptions_of(flow_of(body), lambda instance: self._raised[self._classes[instance]], _from_outside)[0]

    def may(self, body: ir.Action, exception: str) -> bool:
        """Whether a composition may raise an exception; any step may fault."""
        if exception == "Fault" or (exception == "Timeout" and any(map(self._samples, parts(body)))):
            return True
        found = self.by(body)
        return found is None or exception in found

    def _samples(self, part: Any) -> bool:
        """Whether it may read a sampled input."""
        match part:
            case ir.RunInstance():
                return True
            case (
                ir.ReadValue(source=end)
                | ir.ReadyEvent(source=end)
                | ir.InputEvent(source=end)
                | ir.InputRead(source=end)
            ):
                return isinstance(end, ir.PortEnd) and end.port in self._sampled
            case _:  # Any other part of the composition.
                return False


def _from_outside(instruction: Instruction) -> Exceptions:
    """The exceptions of an instruction that calls another language: a law in another language may raise any
    exception.
    """
    law = instruction.step if isinstance(instruction, Compute) else None
    is_external = isinstance(law, ir.RunLaw) and any(isinstance(equation, ExternalCall) for equation in law.equations)
    return None if is_external else NO_EXCEPTIONS


def _without_unused_instances(entry: ProcessClass, classes: Mapping[str, Class]) -> ProcessClass:
    run = {part.instance for part in all_actions(entry.body) if isinstance(part, (ir.RunInstance, ir.ResetInstance))}
    kept = [item for item in entry.instances if item.name in run or _is_waited_for(classes[item.class_name])]
    return entry if len(kept) == len(entry.instances) else replaced(entry, instances=tuple(kept))


def _is_waited_for(entry: Class) -> bool:
    """Whether an instance is needed although it is not run."""
    return isinstance(entry, ProcessClass) and bool(possible_broadcasts(entry))


def _without_unused_parts(entry: ProcessClass, classes: Mapping[str, Class], keep_ports: bool) -> ProcessClass:
    """The class without ports, channels, parameters and entries of the creation order that are not mentioned in it."""

    known: dict[str, tuple[set[str], set[str]]] = {}

    def connected(instance: Any) -> Any:
        inner = classes[instance.class_name]
        if inner.name not in known:
            known[inner.name] = ({port.name for port in inner.ports}, {item.name for item in inner.parameters})
        ports, names = known[inner.name]
        return changed(
            instance,
            connections=_kept(instance.connections, lambda connection: connection.port in ports),
            arguments=_kept(instance.arguments, lambda argument: argument[0] in names),
        )

    entry = changed(entry, instances=mapped(entry.instances, connected))
    mentioned = _mentioned(entry)
    if not keep_ports:
        entry = changed(entry, ports=_kept(entry.ports, lambda port: port.name in mentioned.ports))
    entry = changed(entry, channels=_kept(entry.channels, lambda channel: channel.name in mentioned.channels))
    entry = changed(
        entry,
        parameters=_kept(entry.parameters, lambda parameter: parameter.name in mentioned.parameters),
        ports=mapped(entry.ports, lambda port: _with_known_period(port, mentioned.parameters)),
    )
    return changed(entry, creation=_creation(entry))


def _kept(items: tuple[Any, ...], keep: Callable[[Any], bool]) -> tuple[Any, ...]:
    kept = tuple(filter(keep, items))
    return items if len(kept) == len(items) else kept


class _Mentioned:
    def __init__(self) -> None:
        self.ports: set[str] = set()
        self.channels: set[str] = set()
        self.parameters: set[str] = set()


def _mentioned(entry: ProcessClass) -> _Mentioned:
    found = _Mentioned()
    arguments = [instance.arguments for instance in entry.instances if instance.arguments]
    attachments = [connection.attachment for instance in entry.instances for connection in instance.connections]
    for part in parts((entry.body, entry.constants, entry.states, entry.channels, arguments, attachments)):
        match part:
            case ir.PortEnd():
                found.ports.add(part.port)
            case ir.ChannelEnd() | ir.Target() | VariableValue():
                found.channels.add(part.channel)
            case ParameterValue() | TunableValue():
                found.parameters.add(part.name)
            case _:  # Any other part mentions none.
                pass
    return found


def _with_known_period(port: Port, parameters: set[str]) -> Port:
    """The port without its period if that needs parameters which are otherwise unused: the period is only
    documentation.
    """
    needed = {part.name for part in parts(port.period) if isinstance(part, ParameterValue)}
    return port if needed <= parameters else replaced(port, period=None)


def _creation(entry: ProcessClass) -> tuple[Any, ...]:
    ends: set[Any] = set()
    choices: set[str] = set()
    for part in parts(entry.body):
        match part:
            case ir.ReadValue() | ir.ReadyEvent() | ir.InputEvent():
                ends.add(part.source)
            case ir.ReadInputs():
                ends.update(read.source for read in part.reads)
            case ir.ProcessScope():
                ends.update(part.ends)
            case ir.Choice():
                choices.add(part.name)
            case _:  # Any other part makes none.
                pass
    ends.update(connection.attachment for instance in entry.instances for connection in instance.connections)
    broadcasts = possible_broadcasts(entry)
    ends.update(end for end in entry.creation if ends_at(end, broadcasts))
    instances = {instance.name for instance in entry.instances}

    def is_kept(item: Any) -> bool:
        match item:
            case CreatedInstance():
                return item.instance in instances
            case CreatedChoice():
                return item.choice in choices
            case _:  # An end.
                return item in ends

    return _kept(entry.creation, is_kept)


def _without_arguments(network: Network) -> Network:
    """The network without arguments for parameters that have been removed."""
    names_of = {entry.name: {parameter.name for parameter in entry.parameters} for entry in network.classes}

    def cut(item: Instantiation) -> Instantiation:
        return changed(item, arguments=_kept(item.arguments, lambda entry: entry[0] in names_of[item.class_name]))

    top = names_of[network.top]
    return replaced(
        network,
        arguments=_kept(network.arguments, lambda argument: argument[0] in top),
        tunable=_kept(network.tunable, lambda entry: entry[0] in top),
        instances=mapped(network.instances, cut),
    )
