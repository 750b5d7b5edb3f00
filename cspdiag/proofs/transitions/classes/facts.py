"""What is known of the classes of a network before any process is explored.

**Relevant** are the variables, ports and channels whose values decide a condition somewhere: a condition reads them, or
they flow into something that a condition reads; and the parameters that decide whether a delay takes any time. Only
their values are followed. **Deciding** are those that decide a condition or how long a delay lasts: what a run does
next, and when.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import assert_never

from cspdiag.base.graphs import reached
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Communicate,
    Compute,
    Delay,
    Enter,
    Fork,
    Instruction,
    IterationEnd,
    Join,
    Leave,
    Loop,
    Merge,
    ProcessEnd,
    Raise,
    Resume,
    Select,
    Stop,
    Take,
    Test,
    Unwatch,
    Watch,
)
from cspdiag.network.flow.raised import exceptions_of
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.durations import Durations
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT, TIMEOUT
from cspdiag.proofs.transitions.classes.cuts import boundaries, copied_to
from cspdiag.proofs.transitions.classes.distinguished import AsSpecification, Distinction, Distinguished
from cspdiag.proofs.transitions.classes.faults import Faults, catches_faults
from cspdiag.proofs.transitions.classes.items import Item, all_items_in, items_in, items_of
from cspdiag.proofs.transitions.classes.program import Class, Node, Program
from cspdiag.proofs.transitions.values import values_of_type

NOTHING: Distinguished = {}
"""No port is distinguished."""


class Facts:
    """What follows from the classes of a program, from how the values at its ports are ``distinguished``, and from
    whether it is a ``specification``.
    """

    def __init__(
        self, program: Program, distinguished: Distinguished = NOTHING, specification: AsSpecification | None = None
    ) -> None:
        self.program = program
        self.specification = specification
        self._distinguished = distinguished
        self.boundaries = boundaries(program, {port: apart.cuts for port, apart in distinguished.items()})
        outputs = {port.name for port in program.network.external_ports if port.direction == "out"}
        self.durations = Durations(program.network)
        self.relevant = _relevant(
            program,
            {*distinguished, *(outputs if specification is not None else ())},
            _parameters_of_delays(program, self.durations),
        )
        self._copied = copied_to(program, outputs) if specification is not None else frozenset()
        self.sampled = _sampled_ports(program)
        self.faults = Faults(program.network)
        self._escaping: dict[Node, frozenset[str]] = {}
        self.catches_faults = catches_faults(program.network)

    def distinction(self, port: str) -> Distinction:
        """How the values at an input of the outermost process are distinguished."""
        item: Item = ("port", self.program.network.top, _base(port))
        given = self._distinguished.get(port, Distinction())
        copied = given.copied or item in self._copied
        return Distinction(self.boundaries.get(item, frozenset()), copied, given.values)

    def is_free(self, port: str) -> bool:
        """Whether a specification chooses the values at an input itself."""
        return self.specification is not None and _base(port) in self.specification.free

    def parameters(self, one: Class) -> tuple[str, ...]:
        """The parameters of a class that decide a condition, or whether a delay takes time."""
        names = (parameter.name for parameter in one.definition.parameters)
        return tuple(name for name in names if ("parameter", one.name, name) in self.relevant)

    def escaping(self, node: Node, one: Class) -> frozenset[str]:
        """The exceptions that an action of a class may raise and does not catch."""
        known = self._escaping.get(node)
        if known is None:
            known, _ = exceptions_of(
                flow_of(node.action),
                lambda name: self._of_instance(name, one),
                lambda instruction: self._of_step(instruction, one),
            )
            assert known is not None
            self._escaping[node] = known
        return known

    def _of_step(self, instruction: Instruction, one: Class) -> frozenset[str]:
        match instruction:
            case Take(branch=ir.Branch(event=ir.ReadyEvent(source=end) | ir.InputEvent(source=end))):
                return self._of_read(end, one)
            case Communicate(step=ir.ReadValue(source=end)):
                return self._of_read(end, one) | self._fault
            case (
                Compute(step=ir.AssignValue())
                | Communicate()
                | Delay()
                | Test()
                | Select()
                | Watch(step=ir.InterruptOn())
            ):
                return self._fault
            case (
                Compute() | Call() | Take() | Loop() | IterationEnd() | Fork() | Join() | Merge() | Watch() | Unwatch()
                | Abandon() | Resume() | Raise() | Stop() | Enter() | Leave() | ProcessEnd()
            ):  # fmt: skip
                return frozenset()
            case _:
                assert_never(instruction)

    @property
    def _fault(self) -> frozenset[str]:
        """The exceptions of computations, if any process catches them."""
        return frozenset({FAULT}) if self.catches_faults else frozenset()

    def _of_instance(self, name: str, one: Class) -> frozenset[str]:
        instance = one.instances[name]
        inner = self.program.classes[instance.class_name]
        if isinstance(inner.definition, SubmodelClass):
            sampled = any((inner.name, port.name) in self.sampled for port in inner.definition.ports)
            return self._fault | (frozenset({TIMEOUT}) if sampled else frozenset())
        return frozenset() if inner.body is None else self.escaping(inner.body, inner)

    def _of_read(self, end: ir.End, one: Class) -> frozenset[str]:
        sampled = isinstance(end, ir.PortEnd) and (one.name, end.port) in self.sampled
        return frozenset({TIMEOUT}) if sampled else frozenset()


def deciding(program: Program, *, faults: bool = True) -> frozenset[Item]:
    """The items whose values decide a condition, how long a delay or a time-out lasts, or, with ``faults``, whether a
    computation ends in a fault.
    """
    seeds = _deciding_faults(program) if faults else set()
    for one in program.classes.values():
        if isinstance(one.definition, ProcessClass):
            for part in parts(one.definition.body):
                if isinstance(part, ir.WaitStep | ir.AfterEvent):
                    seeds |= items_in(part.duration, one)
    return _relevant(program, set(), seeds)


def _deciding_faults(program: Program) -> set[Item]:
    """The operands of computations that may fail."""
    seeds: set[Item] = set()
    faults = Faults(program.network)
    for one in program.classes.values():
        made = one.definition
        if isinstance(made, ProcessClass):
            for part in parts(made.body):
                if isinstance(part, Expression) and faults.of_part(part, one.name):
                    seeds |= items_in(part, one)
                elif isinstance(part, ir.Target):
                    seeds |= all_items_in(part.indexes, one)
        elif any(isinstance(part, Expression) and faults.of_part(part, one.name) for part in parts(made)):
            seeds |= {("channel", one.name, state.name) for state in made.states}
            seeds |= {("port", one.name, port.name) for port in made.ports if port.direction == "in"}
    return seeds


def _parameters_of_delays(program: Program, durations: Durations) -> set[Item]:
    """The parameters that decide whether a delay in a class takes any time."""
    return {
        item
        for one in program.classes.values()
        if isinstance(one.definition, ProcessClass)
        for part in parts(one.definition.body)
        if isinstance(part, ir.WaitStep | ir.AfterEvent)
        and not durations.surely_takes_time(one.name, part.duration)
        and not durations.is_over_at_once(one.name, part.duration)
        for item in items_in(part.duration, one)
        if item[0] == "parameter"
    }


def _sampled_ports(program: Program) -> frozenset[tuple[str, str]]:
    """The ports, by class and name, that are connected to a sampled input of the outermost process in some instance."""
    top = program.network.top
    found = {
        (top, _base(p.name)) for p in program.network.external_ports if p.direction == "in" and p.sampling is not None
    }
    for one in reversed(program.classes.values()):
        for instance in one.instances.values():
            for connection in instance.connections:
                end = connection.attachment
                if isinstance(end, ir.PortEnd) and (one.name, end.port) in found:
                    found.add((instance.class_name, connection.port))
    return frozenset(found)


def _base(port: str) -> str:
    return port.split("[", 1)[0]


def _relevant(program: Program, distinguished: set[str], others: Iterable[Item] = ()) -> frozenset[Item]:
    """The items that decide a condition or one of ``others``."""
    flows: defaultdict[Item, set[Item]] = defaultdict(set)
    seeds = set(others)
    for one in program.classes.values():
        if isinstance(one.definition, ProcessClass):
            for item, feeding in _flows(one):
                flows[item] |= feeding
            for condition in _conditions(one.definition):
                seeds |= items_in(condition, one)
    for port in program.network.external_ports:
        has_few = values_of_type(port.type) is not None
        if port.name in distinguished or (has_few and port.direction == "out"):
            seeds.add(("port", program.network.top, _base(port.name)))
    return frozenset(reached(seeds, flows.__getitem__))


def _conditions(definition: ProcessClass) -> Iterator[Expression]:
    for part in parts(definition.body):
        match part:
            case ir.Branch() | ir.Repeat() | ir.WhileLoop() | ir.IfElse():
                condition = part.until if isinstance(part, ir.Repeat) else part.condition
                if condition is not None:
                    yield condition
            case _:  # Any other part has no condition.
                pass


def _flows(one: Class) -> Iterator[tuple[Item, set[Item]]]:
    """Items and what they depend on."""
    definition = one.definition
    assert isinstance(definition, ProcessClass)
    for channel in definition.channels:
        if channel.initial is not None:
            yield ("channel", one.name, channel.name), items_in(channel.initial, one)
    for part in parts(definition.body):
        match part:
            case ir.AssignValue():
                yield ("channel", one.name, part.target.channel), all_items_in((part.value, *part.target.indexes), one)
            case ir.ReadValue() | ir.InputEvent():
                sources = all_items_in(part.target.indexes, one) | items_of(part.source, one)
                yield ("channel", one.name, part.target.channel), sources
            case ir.WriteValue() | ir.OutputEvent():
                for sink in items_of(part.sink, one):
                    yield sink, items_in(part.value, one)
            case _:  # Any other part sets and writes nothing.
                pass
    for instance in definition.instances:
        for connection in instance.connections:
            inner: Item = ("port", instance.class_name, connection.port)
            yield inner, items_of(connection.attachment, one)
            for outer in items_of(connection.attachment, one):
                yield outer, {inner}
        for parameter, argument in instance.arguments:
            yield ("parameter", instance.class_name, parameter), items_in(argument, one)
