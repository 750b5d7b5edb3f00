"""Computes control laws in the process that runs them, without calls, with their states next to its variables."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base.record import replaced
from cspdiag.network.flow.waiting import READ_AT_ONCE
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, SignalValue, VariableValue
from cspdiag.network.ir.network import (
    Attachment,
    ConstantEnd,
    CreatedInstance,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    MediumKind,
    Network,
    Port,
    ProcessClass,
    SubmodelClass,
    SubmodelState,
)
from cspdiag.network.ir.walk import all_actions
from cspdiag.optimize.changes import in_sequence, rebuilt
from cspdiag.optimize.flatten.naming import parameter_constants, renamed, renamed_equation
from cspdiag.optimize.reachable import reachable


def inline_laws(network: Network) -> Network:
    """The network with every submodel inlined into the process around it, except those written by hand or with a part
    in C.

    A run becomes ``ReadInputs``, ``RunLaw`` and ``WriteOutputs``. Reads and writes are points of cancellation even if
    nothing is read or written; such empty ones are kept in programs in which another process can observe the
    cancellation.
    """
    laws = {
        entry.name: entry for entry in network.classes if isinstance(entry, SubmodelClass) and not _is_by_hand(entry)
    }
    if not laws:
        return reachable(network)
    seen = any(
        isinstance(part, ir.InterruptOn | ir.CatchException)
        for entry in network.classes
        if isinstance(entry, ProcessClass)
        for part in all_actions(entry.body)
    ) or any(isinstance(entry, ProcessClass) and entry.external for entry in network.classes)
    classes = [
        _Inlining(entry, laws, seen).result() if isinstance(entry, ProcessClass) else entry for entry in network.classes
    ]
    return reachable(replaced(network, classes=tuple(classes)))


def _is_by_hand(law: SubmodelClass) -> bool:
    """Whether a law has a struct of its own in C, written by hand, and so cannot be split."""
    calls = (entry for entry in law.equations if isinstance(entry, ExternalCall))
    return law.external is not None or any(call.external.language == "c" for call in calls)


class _Inlining:
    """Inlines the laws of one process class; with ``seen`` other processes can observe cancellation."""

    def __init__(self, entry: ProcessClass, laws: Mapping[str, SubmodelClass], seen: bool) -> None:
        self.entry = entry
        self.laws = {
            i.name: _Inlined(i, laws[i.class_name], entry, seen) for i in entry.instances if i.class_name in laws
        }

    def result(self) -> ProcessClass:
        entry = self.entry
        if not self.laws:
            return entry
        assert entry.body is not None
        inlined = self.laws.values()
        return replaced(
            entry,
            body=rebuilt(entry.body, self._inlined),
            instances=tuple(instance for instance in entry.instances if instance.name not in self.laws),
            constants=(*entry.constants, *(constant for law in inlined for constant in law.constants)),
            states=(*entry.states, *(state for law in inlined for state in law.states)),
            creation=tuple(
                part
                for part in entry.creation
                if not (isinstance(part, CreatedInstance) and part.instance in self.laws)
            ),
        )

    def _inlined(self, action: ir.Action) -> ir.Action:
        match action:
            case ir.RunInstance(instance=name) if name in self.laws:
                return self.laws[name].run(action)
            case ir.ResetInstance(instance=name) if name in self.laws:
                return in_sequence(self.laws[name].reset(action), action)
            case _:  # Any other action is unchanged.
                return action


class _Inlined:
    """One instance of a law, inlined in a process class."""

    def __init__(self, instance: InstanceOf, law: SubmodelClass, owner: ProcessClass, seen: bool) -> None:
        self.instance = instance
        self.law = law
        self.owner = owner
        self.seen = seen
        self.prefix = instance.name
        self.channels = {channel.name: channel for channel in owner.channels}
        self.media = {port.name: port.media for port in owner.ports}
        self.attachments = {(c.port, c.index): c.attachment for c in instance.connections}
        self.values, given = parameter_constants(instance, law.parameters)
        self.signals: dict[str, Expression] = {}
        """The expressions that replace inputs which are not read."""
        defaults = self._defaults()
        self.constants = (*given, *defaults, *(self._equation(constant) for constant in law.constants))
        self.states = tuple(self._state(state) for state in law.states)

    def _defaults(self) -> tuple[SubmodelEquation, ...]:
        """Constants for the inputs with a constant value, except for literals and parameters, which are used
        directly.
        """
        constants = []
        for name, port, attachment in self._elements("in"):
            if isinstance(attachment, ConstantEnd):
                value = attachment.value
                if not isinstance(value, LiteralValue | ParameterValue):
                    full = f"{self.prefix}.{name}"
                    constants.append(SubmodelEquation(name=full, span=port.span, type=port.type, value=value))
                    value = SignalValue(type=port.type, name=full)
                self.signals[name] = value
        return tuple(constants)

    def _elements(self, direction: str) -> list[tuple[str, Port, Attachment]]:
        """The signal, port and attachment of each element of each port, in order."""
        found = []
        for port in self.law.ports:
            if port.direction == direction:
                for index in [None] if port.size is None else range(port.size):
                    name = port.name if index is None else f"{port.name}[{index}]"
                    found.append((name, port, self.attachments[port.name, index]))
        return found

    def _equation(self, equation: SubmodelEquation) -> SubmodelEquation:
        renamed_one = renamed_equation(equation, self.prefix, self.values, self.signals)
        assert isinstance(renamed_one, SubmodelEquation)
        return renamed_one

    def _renamed(self, value: Expression) -> Expression:
        return renamed(value, self.prefix, self.values, self.signals)

    def _state(self, state: SubmodelState) -> SubmodelState:
        return replaced(state, name=f"{self.prefix}.{state.name}", initial=self._renamed(state.initial))

    def reset(self, action: ir.ResetInstance) -> list[ir.Action]:
        """The steps of a reset: of states, and of what is written by hand within the law."""
        names = [state.name for state in self.states]
        names += [f"{self.prefix}.{call.name}" for call in self.law.equations if isinstance(call, ExternalCall)]
        return [ir.ResetStates(span=action.span, states=tuple(names))] if names else []

    def run(self, action: ir.RunInstance) -> ir.Action:
        """The steps of a run."""
        law = self.law
        reads, variables = self._inputs()
        kinds = {self._kind(read.source) for read in reads}
        steps: list[ir.Action] = []
        if reads or self.seen:
            steps.append(ir.ReadInputs(span=law.span, reads=reads, law=self.prefix))
        equations = [renamed_equation(item, self.prefix, self.values, self.signals) for item in law.equations]
        if equations or variables or law.next_values or law.derivatives:
            steps.append(self._law(action, (*variables, *equations)))
        steps += self._outputs(may_have_waited=not kinds <= READ_AT_ONCE)
        return in_sequence(steps, action)

    def _law(self, action: ir.RunInstance, equations: tuple[SubmodelEquation | ExternalCall, ...]) -> ir.RunLaw:
        law = self.law
        return ir.RunLaw(
            span=action.span,
            law=self.prefix,
            equations=equations,
            next_values=self._by_state(law.next_values),
            derivative_equations=tuple(map(self._equation, law.derivative_equations)),
            derivatives=self._by_state(law.derivatives),
            method=law.method,
            step=law.step,
            sample=self._sample() if law.derivatives else None,
            doc=law.doc,
        )

    def _by_state(self, values: tuple[tuple[str, Expression], ...]) -> tuple[tuple[str, Expression], ...]:
        return tuple((f"{self.prefix}.{name}", self._renamed(value)) for name, value in values)

    def _sample(self) -> Expression:
        if "sample" in self.values:
            return self.values["sample"]
        constant = next(item for item in self.law.constants if item.name == "sample")
        return SignalValue(type=constant.type, name=f"{self.prefix}.sample")

    def _kind(self, end: Attachment) -> MediumKind:
        match end:
            case ir.ChannelEnd(channel=name):
                return self.channels[name].kind
            case ir.PortEnd(port=name, index=index):
                return self.media[name][index or 0].kind
            case ConstantEnd():
                return "constant"
            case DiscardEnd():
                return "discard"

    def _inputs(self) -> tuple[tuple[ir.InputRead, ...], list[SubmodelEquation]]:
        """The inputs to read, in order, and equations for the inputs that are variables of the class.

        A variable that may not have been written is read in order with the others, so a fault occurs at the same place.
        """
        ends = [
            (name, port, end) for name, port, end in self._elements("in") if isinstance(end, ir.ChannelEnd | ir.PortEnd)
        ]
        sure = [self._is_variable(end) is not None for _, _, end in ends]
        if not all(sure):
            sure = [self._is_written(end) for _, _, end in ends]
        reads, equations = [], []
        for is_sure, (name, port, end) in zip(sure, ends, strict=True):
            full = f"{self.prefix}.{name}"
            if is_sure and isinstance(end, ir.ChannelEnd):
                value = VariableValue(type=port.type, channel=end.channel, span=port.span)
                equations.append(SubmodelEquation(name=full, doc=port.doc, span=port.span, type=port.type, value=value))
            else:
                reads.append(ir.InputRead(source=end, name=full, type=port.type))
        return tuple(reads), equations

    def _is_variable(self, end: Attachment) -> LocalChannel | None:
        channel = self.channels.get(end.channel) if isinstance(end, ir.ChannelEnd) else None
        return channel if channel is not None and channel.kind == "var" else None

    def _is_written(self, end: Attachment) -> bool:
        channel = self._is_variable(end)
        return channel is not None and channel.initial is not None

    def _outputs(self, *, may_have_waited: bool) -> list[ir.Action]:
        """The steps that write the outputs: assignments if all are variables, otherwise one step, in the order of the
        writes.
        """
        span = self.law.span
        writes = tuple(
            ir.OutputWrite(sink=end, value=SignalValue(type=port.type, name=f"{self.prefix}.{name}"))
            for name, port, end in self._elements("out")
            if isinstance(end, ir.ChannelEnd | ir.PortEnd)
        )
        if any(self._is_variable(write.sink) is None for write in writes):
            return [ir.WriteOutputs(span=span, writes=writes, law=self.prefix)]
        steps: list[ir.Action] = []
        if self.seen and may_have_waited:
            steps.append(ir.WriteOutputs(span=span, writes=(), law=self.prefix))
        for write in writes:
            assert isinstance(write.sink, ir.ChannelEnd)
            steps.append(ir.AssignValue(span=span, target=ir.Target(write.sink.channel), value=write.value))
        return steps
