"""The constructs of a program: random programs have to contain all of them, and shrunk ones are described by them."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import field_names
from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, TimeType, Type
from cspdiag.network.ir import actions as act
from cspdiag.network.ir import expressions as ex
from cspdiag.network.ir.network import (
    ClassParameter,
    ConstantEnd,
    DiscardEnd,
    ExternalPort,
    Network,
    ProcessClass,
    SubmodelClass,
    SubmodelState,
)
from cspdiag.network.ir.walk import instances_run, parts
from cspdiag.optimize import lower_for_targets

PREDEFINED = ("Fault", "Timeout")


def constructs(network: Network) -> set[str]:
    """The names of all constructs in a network before any pass."""
    found = {f"on miss {environment.on_miss}" for environment in network.environments}
    if network.constants:
        found.add("named constant")
    for port in network.external_ports:
        found.add(_external(port))
        found.add(f"type {_type(port.type)}")
    for entry in network.classes:
        if entry.wcet is not None:
            found.add("wcet")
        found.update(_process(network, entry) if isinstance(entry, ProcessClass) else _submodel(entry))
    for net in network.nets:
        found.add(f"channel of {_type(net.type)}")
    found.update(_guarded_media(lower_for_targets(network)))
    return found


def _external(port: ExternalPort) -> str:
    if port.sampling is None:
        shared = f" {port.kind}" if port.kind != "sync" else ""
        return f"event {port.direction}put{shared}"
    safe = " with safe value" if port.safe is not None else ""
    offset = " with offset" if port.sampling.offset else ""
    return f"sampled {port.direction}put{offset}" + (" immediate" if port.immediate else "") + safe


def _process(network: Network, entry: ProcessClass) -> Iterator[str]:
    for channel in entry.channels:
        yield f"channel {channel.kind}"
        yield f"type {_type(channel.type)}"
    for port in entry.ports:
        if port.size is not None:
            yield f"array of {port.direction} ports"
    for instance in entry.instances:
        inner = network.class_named(instance.class_name)
        kind = "process" if isinstance(inner, ProcessClass) else "submodel"
        yield f"instance of a {kind}" + (" in an array" if instance.array is not None else "")
        if isinstance(inner, ProcessClass) and inner.instances:
            yield "process of processes"
        for connection in instance.connections:
            if isinstance(connection.attachment, ConstantEnd):
                yield f"default of a {kind}'s input"
            elif isinstance(connection.attachment, DiscardEnd):
                yield f"discarded output of a {kind}"
    for parameter in entry.parameters:
        yield from _parameter(parameter, "process")
    if entry.body is not None:
        runs = instances_run(entry.body)
        if any(runs.count(name) > 1 for name in runs):
            yield "instance run twice"
        yield from _action(network, entry, entry.body, ())


def _parameter(parameter: ClassParameter, kind: str) -> Iterator[str]:
    if not parameter.derived:
        yield f"parameter of a {kind}"


def _submodel(entry: SubmodelClass) -> Iterator[str]:
    for port in entry.ports:
        yield f"submodel {port.direction}put of {_type(port.type)}"
        if "[" in port.name:
            yield f"array of submodel {port.direction}puts"
    for parameter in entry.parameters:
        yield from _parameter(parameter, "submodel")
    if entry.constants:
        yield "constant of a submodel"
    if entry.derivatives:
        yield f"integration {entry.method}" + (" in steps" if entry.step is not None else "")
    for part in parts((entry.constants, entry.states, entry.equations, entry.next_values, entry.derivatives)):
        if isinstance(part, SubmodelState):
            yield f"{'continuous' if part.continuous else 'discrete'} state of {_type(part.type)}"
        yield from _expression(part)


COMPOSED = (
    act.ParallelSteps | act.Choice | act.Repeat | act.WhileLoop | act.CatchException | act.InterruptOn | act.Group
)


def _action(network: Network, entry: ProcessClass, action: act.Action, inside: tuple[str, ...]) -> Iterator[str]:
    name = _named(network, entry, action)
    yield name
    if isinstance(action, COMPOSED):
        kind = type(action).__name__
        yield from (f"{kind} in {outer}" for outer in dict.fromkeys(inside))
        inside = (*inside, kind)
    elif isinstance(action, act.RunInstance) and "ParallelSteps" in inside:
        yield f"{name} in a parallel"
    branches: tuple[act.Branch, ...] = ()
    if isinstance(action, act.Choice):
        branches = action.branches
    elif isinstance(action, act.InterruptOn):
        branches = (action.branch,)
    for branch in branches:
        yield (
            f"{name} with {_guard(branch)}" if len(branches) > 1 or name == "InterruptOn" else f"lone {_guard(branch)}"
        )
        yield from _action(network, entry, branch.body, inside)
    for part in _own_parts(action):
        yield from _expression(part)
        if isinstance(part, act.PortEnd | act.ChannelEnd) and part.end > 0:
            yield "several ends of one input"
        if isinstance(part, act.PortEnd) and part.index is not None:
            yield "element of an array of ports"
        if isinstance(part, act.Target) and part.indexes:
            yield "assignment to an element"
    for inner in _inside(action):
        yield from _action(network, entry, inner, inside)


def _named(network: Network, entry: ProcessClass, action: act.Action) -> str:
    name = type(action).__name__
    match action:
        case act.RunInstance(instance=instance):
            class_name = next(item.class_name for item in entry.instances if item.name == instance)
            return f"run of a {'process' if isinstance(network.class_named(class_name), ProcessClass) else 'submodel'}"
        case act.ParallelSteps(prioritized=True) | act.Choice(prioritized=True):
            return f"{name} prioritized"
        case act.Repeat(until=None):
            return f"{name} forever"
        case act.CatchException(exception=exception) | act.RaiseException(exception=exception):
            return f"{name} of {exception if exception in PREDEFINED else 'a declared one'}"
        case _:
            return name


def _guard(branch: act.Branch) -> str:
    return f"{type(branch.event).__name__}" + (" under a condition" if branch.condition is not None else "")


def _inside(action: act.Action) -> tuple[act.Action, ...]:
    """The actions directly inside, except those after guards."""
    match action:
        case act.SequentialSteps(steps=steps) | act.ParallelSteps(steps=steps):
            return steps
        case act.IfElse():
            return (action.then, action.otherwise)
        case act.CatchException():
            return (action.body, action.handler)
        case act.Repeat(body=body) | act.WhileLoop(body=body) | act.CountedLoop(body=body):
            return (body,)
        case act.Group(body=body) | act.InterruptOn(body=body):
            return (body,)
        case _:
            return ()


def _own_parts(action: act.Action) -> Iterator[object]:
    """The records of an action that are not in another action inside it."""
    for name in field_names(action):
        value = getattr(action, name)
        if name == "branches":
            yield from (part for branch in value for part in parts((branch.condition, branch.event)))
        elif name == "branch":
            yield from parts((value.condition, value.event))
        elif name not in ("span", "type", "steps", "body", "then", "otherwise", "handler"):
            yield from parts((value,))


def _expression(part: object) -> Iterator[str]:
    match part:
        case ex.UnaryOperation(operator=operator) | ex.BinaryOperation(operator=operator):
            yield f"{operator} on {_type(part.left.type if isinstance(part, ex.BinaryOperation) else part.type)}"
        case ex.FunctionCall(function=function):
            yield f"{function} of {_type(part.type)}"
        case ex.Conversion():
            yield f"conversion of {_type(part.operand.type)} to {_type(part.type)}"
        case ex.Typed():
            yield type(part).__name__
        case _:
            return


def _guarded_media(network: Network) -> Iterator[str]:
    """The kinds of channels at which alternatives and interrupts wait, and on which side."""
    for entry in network.classes:
        if not isinstance(entry, ProcessClass):
            continue
        media = [medium for port in entry.ports for medium in port.media]
        for medium in (*media, *entry.channels):
            if medium.guarded_reads:
                yield f"{medium.kind} with input guards"
            if medium.guarded_writes:
                yield f"{medium.kind} with output guards"


def _type(kind: Type) -> str:
    match kind:
        case IntType() | RealType() | BoolType() | TimeType():
            return str(kind)
        case EnumType():
            return "an enum"
        case StructType(fields=fields):
            return f"a struct of {' and '.join(_type(inner) for _, inner in fields)}"
        case ArrayType(element=element):
            return f"an array of {_type(element)}"
        case _:
            return "something else"
