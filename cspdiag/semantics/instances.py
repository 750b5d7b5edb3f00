"""The tree of instances of a network: what each port is attached to, and what each process does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, assert_never

from cspdiag.network.ir import actions as act
from cspdiag.network.ir.expressions import Expression, TunableValue
from cspdiag.network.ir.network import (
    Connection,
    ConstantEnd,
    CreatedChoice,
    CreatedInstance,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    Network,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.semantics import media
from cspdiag.semantics.choice import Choose, Interrupt
from cspdiag.semantics.ends import choices, ends_read, flattened_ends
from cspdiag.semantics.media import EndKey, Medium, Offer, Place
from cspdiag.semantics.outside import MissedSampleError
from cspdiag.semantics.requests import Communicate, Parallel, Request, Steps, Wait
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.semantics.submodels import InlinedLaws, SubmodelInstance
from cspdiag.semantics.values import FaultError, RaisedError, value_of, within


class DeclaredError(RaisedError):
    """A declared exception. «Exceptions»"""


class Program:
    """What all instances share: the network, the scheduler, and the numbers of alternatives. «Parties, channels and
    guards»
    """

    def __init__(self, network: Network, world: Scheduler) -> None:
        self.network = network
        self.world = world
        self.alternatives: dict[tuple[str, str], int] = {}
        """The numbers of alternatives, in the order in which they are created, by the path of the process and the name
        in it.
        """


class ProcessInstance:
    """An instance of a process: its variables and channels, and the instances inside.

    «Processes and ports», «Parties, channels and guards»
    """

    def __init__(
        self,
        program: Program,
        cls: ProcessClass,
        path: str,
        parameters: Mapping[str, Any],
        ports: Mapping[Place, Medium],
    ) -> None:
        assert cls.external is None, "bodies in other languages have no specification"
        self.program = program
        self.world = program.world
        self.cls = cls
        self.path = path
        self.parameters = parameters
        self.ports = ports
        self.memories: dict[str, dict[str, int]] = {}
        """For each alternative the guard that it chose last, which is kept when the process runs again."""
        self.laws = InlinedLaws(cls, parameters, self._variable)
        self.channels = {channel.name: self._channel(channel) for channel in cls.channels}
        self.processes: dict[str, ProcessInstance] = {}
        self.submodels: dict[str, SubmodelInstance] = {}
        assert cls.body is not None
        self.flattened = {end: f"{path}.{instance}" for end, instance in flattened_ends(cls.body)}
        """For each end of a process that was flattened into this one the path of that process."""
        instances = {instance.name: instance for instance in cls.instances}
        for made in cls.creation or self._in_text_order():
            match made:
                case act.PortEnd() | act.ChannelEnd():
                    self.medium(made).register(self.key(made))
                case CreatedInstance():
                    self._create(instances.pop(made.instance))
                case CreatedChoice(choice=name):
                    self._number(name)
                case _:
                    assert_never(made)
        for instance in instances.values():
            self._create(instance)
        for choice in choices(cls.body):
            self._number(_memory(choice))

    def _number(self, alternative: str) -> None:
        """The alternatives of a process are created after its instances."""
        numbers = self.program.alternatives
        numbers.setdefault((self.path, alternative), len(numbers))

    def _in_text_order(self) -> Iterator[act.End | CreatedInstance]:
        """The ends of the process itself and of its submodels, and then the instances of processes inside."""
        cls = self.cls
        assert cls.body is not None
        yield from ends_read(cls.body)
        for instance in cls.instances:
            inner = self.program.network.class_named(instance.class_name)
            if isinstance(inner, SubmodelClass):
                inputs = {port.name for port in inner.ports if port.direction == "in"}
                for connection in instance.connections:
                    end = connection.attachment
                    if connection.port in inputs and not isinstance(end, ConstantEnd | DiscardEnd):
                        yield end
        yield from (CreatedInstance(instance.name) for instance in cls.instances)

    def _create(self, instance: InstanceOf) -> None:
        inner = self.program.network.class_named(instance.class_name)
        arguments = {
            name: self.parameters[value.name] if isinstance(value, TunableValue) else self.value(value)
            for name, value in instance.arguments
        }
        if isinstance(inner, ProcessClass):
            joined = {(c.port, c.index): self.attached(c) for c in instance.connections}
            path = f"{self.path}.{instance.name}"
            self.processes[instance.name] = ProcessInstance(self.program, inner, path, arguments, joined)
        else:
            self.submodels[instance.name] = SubmodelInstance(self, inner, arguments, instance.connections)

    def _channel(self, channel: LocalChannel) -> Medium:
        name = f"{self.path}.{channel.name}"
        match channel.kind:
            case "var":
                initial = None if channel.initial is None else self.value(channel.initial)
                return media.Variable(self.world, name, initial)
            case "sync" | "any":
                return media.Rendezvous(self.world, name)
            case "broadcast":
                return media.Broadcast(self.world, name)
            case "buffer" | "overwrite":
                assert channel.capacity is not None
                return media.Fifo(self.world, name, channel.capacity, channel.kind == "overwrite")
            case _:
                assert_never(channel.kind)

    def attached(self, connection: Connection) -> Medium:
        """The medium that a port of an instance inside is attached to. «The communication diagram»"""
        match connection.attachment:
            case ConstantEnd(value=value):
                return media.NonBlocking(self.world, "", self.value(value))
            case DiscardEnd():
                return media.NonBlocking(self.world, "")
            case end:  # A port or a channel.
                return self.medium(end)

    def medium(self, end: act.End) -> Medium:
        """The medium that an end belongs to. «The communication diagram»"""
        return self.ports[end.port, end.index] if isinstance(end, act.PortEnd) else self.channels[end.channel]

    def key(self, end: act.End) -> EndKey:
        """The end as one of this process, or of one that was flattened into it, whose sessions it has. «Time»"""
        owner = self.flattened.get(end, self.path)
        if isinstance(end, act.PortEnd):
            return (owner, end.port, end.index, end.end)
        return (owner, f".{end.channel}", None, end.end)

    def value(self, expression: Expression) -> Any:
        """The value of an expression over parameters, variables, and signals of inlined control laws.

        «Expressions»
        """
        return value_of(expression, self.parameters, self._variable, self.laws.values.__getitem__, self.world.now)

    def holds(self, condition: Expression) -> bool:
        """The value of a condition. «Expressions»"""
        return bool(self.value(condition))

    def _variable(self, name: str) -> Any:
        variable = self.channels[name]
        assert isinstance(variable, media.Variable)
        return variable.value

    def assign(self, target: act.Target, value: Any) -> None:
        """Assign a value to a variable or an element of it. «The composition diagram»"""
        variable = self.channels[target.channel]
        assert isinstance(variable, media.Variable)
        indexes = [self.value(index) for index in target.indexes]
        variable.value = _replaced(variable.value, indexes, value) if indexes else value

    def run(self) -> Steps:
        """All steps of the process, from start to end. «The composition diagram»"""
        assert self.cls.body is not None
        self.world.process_started(self.path, self.cls.name)
        try:
            yield from self.steps(self.cls.body)
        finally:
            self.world.process_ended(self.path)

    def steps(self, action: act.Action) -> Steps:
        """What each form of composition does. «The composition diagram», «Guards», «Exceptions»"""
        match action:
            case act.RunInstance(instance=name):
                yield from (self.processes[name].run() if name in self.processes else self.submodels[name].run())
            case act.ReadValue():
                yield from self._read(action.source, action.target)
            case act.WriteValue():
                yield from self._write(action.sink, action.value)
            case act.AssignValue():
                self.assign(action.target, self.value(action.value))
            case act.SkipStep():
                return
            case act.StopStep():
                yield Wait(None)
            case act.WaitStep():
                yield Wait(self.value(action.duration))
            case act.ResetInstance():
                self.submodels[action.instance].law.reset()
            case act.RaiseException():
                raise DeclaredError(action.exception)
            case act.SequentialSteps():
                for step in action.steps:
                    yield from self.steps(step)
            case act.ParallelSteps():
                yield Parallel([self.steps(step) for step in action.steps], action.prioritized)
            case act.Choice(branches=(act.Branch(condition=None, event=event) as branch,)) if not isinstance(
                event, act.ReadyEvent
            ):
                yield from self._alone(event)
                yield from self.steps(branch.body)
            case act.Choice():
                chosen = yield self._alternative(action.branches, action.prioritized, _memory(action))
                yield from self._guarded(action.branches, chosen)
            case act.Repeat():
                while True:
                    yield from self.steps(action.body)
                    if action.until is not None and self.holds(action.until):
                        return
            case act.WhileLoop():
                while self.holds(action.condition):
                    yield from self.steps(action.body)
            case act.CountedLoop():
                for _ in range(action.iterations):
                    yield from self.steps(action.body)
            case act.IfElse():
                yield from self.steps(action.then if self.holds(action.condition) else action.otherwise)
            case act.CatchException():
                yield from self._catching(action)
            case act.InterruptOn(branch=branch) if branch.condition is not None and not self.holds(branch.condition):
                yield from self.steps(action.body)
            case act.InterruptOn():
                guard = self._alternative((action.branch,), True, f"at {id(action)}")
                chosen = yield Interrupt(self.steps(action.body), guard)
                if chosen is not None:
                    yield from self._guarded((action.branch,), chosen)
            case act.Group():
                path = f"{self.path}.{action.label}"
                self.world.process_started(path, "")
                try:
                    yield from self.steps(action.body)
                finally:
                    self.world.group_ended(path)
            case act.ProcessScope(instance=path):
                try:
                    yield from self.steps(action.body)
                finally:
                    self.world.process_ended(f"{self.path}.{path}")
            case act.ReadInputs(reads=reads):
                request = Communicate()
                request.offers += [self._reader(request, read.source) for read in reads]
                values = yield request
                self.laws.values.update(zip((read.name for read in reads), values, strict=True))
            case act.RunLaw():
                self.laws.run(action)
            case act.WriteOutputs(writes=writes):
                request = Communicate()
                values = [self.value(write.value) for write in writes]
                for write, value in zip(writes, values, strict=True):
                    request.offers.append(self._writer(request, write.sink, value))
                yield request
            case act.ResetStates(states=states):
                self.laws.reset(states)
            case act.ReportCommunication():
                self.world.communicate(f"{self.path}.{action.channel}", self.value(action.value))
            case _:
                assert_never(action)

    def _read(self, source: act.End, target: act.Target) -> Steps:
        medium = self.medium(source)
        if isinstance(medium, media.NonBlocking) and not medium.communicates:
            self.assign(target, medium.value)
            return
        request = Communicate()
        request.offers.append(self._reader(request, source))
        (value,) = yield request
        self.assign(target, value)

    def _write(self, sink: act.End, value: Expression) -> Steps:
        medium = self.medium(sink)
        if isinstance(medium, media.NonBlocking) and not medium.communicates:
            medium.write(self.value(value))
            return
        request = Communicate()
        request.offers.append(self._writer(request, sink, self.value(value)))
        yield request

    def _alone(self, event: act.Event) -> Steps:
        """An alternative with one guard, which is the same as the communication or the delay of the guard."""
        match event:
            case act.InputEvent():
                yield from self._read(event.source, event.target)
            case act.OutputEvent():
                yield from self._write(event.sink, event.value)
            case act.AfterEvent():
                yield Wait(self.value(event.duration))
            case act.ReadyEvent() | act.SkipEvent():
                return
            case _:
                assert_never(event)

    def _catching(self, action: act.CatchException) -> Steps:
        caught = False
        try:
            yield from self.steps(action.body)
        except (DeclaredError, FaultError, MissedSampleError) as error:
            if exception_name(error) != action.exception:
                raise
            caught = True
        if caught:
            yield from self.steps(action.handler)

    def _reader(self, request: Request, end: act.End) -> Offer:
        return Offer(request, self.medium(end), self.key(end), writes=False)

    def _writer(self, request: Request, end: act.End, value: Any) -> Offer:
        return Offer(request, self.medium(end), self.key(end), writes=True, value=value)

    def _alternative(self, branches: tuple[act.Branch, ...], prioritized: bool, memory: str) -> Choose:
        number = self.program.alternatives.get((self.path, memory), 0)
        request = Choose(prioritized, self.memories.setdefault(memory, {}), number)
        for index, branch in enumerate(branches):
            if branch.condition is not None and not self.holds(branch.condition):
                continue
            event = branch.event
            match event:
                case act.SkipEvent():
                    request.always.add(index)
                case act.AfterEvent():
                    request.timeouts[index] = self.world.now + self.value(event.duration)
                case act.OutputEvent():
                    request.offers[index] = self._writer(request, event.sink, self.value(event.value))
                case act.InputEvent() | act.ReadyEvent():
                    request.offers[index] = self._reader(request, event.source)
                    request.offers[index].only_ready = isinstance(event, act.ReadyEvent)
                case _:
                    assert_never(event)
            if index in request.offers:
                request.offers[index].guard = index
        return request

    def _guarded(self, branches: tuple[act.Branch, ...], chosen: tuple[int, Any]) -> Steps:
        index, value = chosen
        event = branches[index].event
        if isinstance(event, act.InputEvent):
            self.assign(event.target, value)
        yield from self.steps(branches[index].body)


def exception_name(error: RaisedError) -> str:
    """The name of an exception in the language. «Exceptions»"""
    match error:
        case FaultError():
            return "Fault"
        case MissedSampleError():
            return "Timeout"
        case _:  # An exception that the program declares.
            return str(error)


def _memory(choice: act.Choice) -> str:
    return choice.name or f"at {id(choice)}"


def _replaced(whole: Any, indexes: list[int], value: Any) -> Any:
    if not indexes:
        return value
    index = within(indexes[0], whole)
    return (*whole[:index], _replaced(whole[index], indexes[1:], value), *whole[index + 1 :])
