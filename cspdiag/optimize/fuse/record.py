"""What occurs in a symbolic execution, recorded as actions of one process."""

from __future__ import annotations

from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.model.types import Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, SignalValue, VariableValue
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import channels_written
from cspdiag.optimize.constants.folding import folded_with
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.media import Offer

LARGEST_NUMBER_OF_INSTRUCTIONS = 30_000


@record
class Step:
    """An action at an instant; with ``fresh`` it takes a sample that arrives at this instant, so it waits for it."""

    time: int
    action: ir.Action
    fresh: bool = False


@record
class Decision:
    """A condition that is evaluated, with the outcome that is followed."""

    time: int
    condition: Expression
    holds: bool


Occurrence: TypeAlias = Step | Decision


class Recorder:
    """Records occurrences, and tracks the values of the variables in ``counting`` as long as they are constant."""

    def __init__(self, entry: ProcessClass, counting: frozenset[str]) -> None:
        self.now = 0
        self.occurrences: list[Occurrence] = []
        self.made: dict[str, Type] = {}
        """Additional variables that the record needs, by name."""
        self._names: dict[tuple[str, tuple[int, ...] | None], str] = {}
        self._types = {channel.name: channel.type for channel in entry.channels}
        variables = [channel for channel in entry.channels if channel.kind == "var"]
        self._counting = counting
        self._known = {
            channel.name: channel.initial
            for channel in variables
            if channel.name in counting and isinstance(channel.initial, LiteralValue)
        }
        self._written = {channel.name for channel in variables if channel.initial is not None}
        self._postponed: dict[object, list[ir.Action]] = {}
        self._instructions = 0

    def count_instruction(self) -> None:
        """Raises NotStaticError if the execution takes too long."""
        self._instructions += 1
        if self._instructions > LARGEST_NUMBER_OF_INSTRUCTIONS:
            raise NotStaticError("it takes too long until it repeats")

    def knowledge(self) -> object:
        """The part of the state on which the future depends."""
        known = tuple(sorted((name, repr(value.value)) for name, value in self._known.items()))
        return known, frozenset(self._written), frozenset(self._postponed)

    def folded(self, expression: Expression) -> Expression:
        """The expression, or its value if that is known."""
        return folded_with(expression, self._known)

    def close(self, process: ir.ProcessScope) -> None:
        """A process with ends has ended; its scope, with an empty body, closes them."""
        self._do(process)

    def decide(self, condition: Expression, holds: bool) -> None:
        """A condition is evaluated."""
        self.occurrences.append(Decision(self.now, condition, holds))

    def _do(self, action: ir.Action, *, fresh: bool = False) -> None:
        self.occurrences.append(Step(self.now, action, fresh))

    def compute_action(self, action: ir.Action) -> None:
        """A computation, or a write to the environment."""
        if isinstance(action, ir.AssignValue) and not action.target.indexes:
            value = self.folded(action.value)
            known = isinstance(value, LiteralValue) and action.target.channel in self._counting
            self._do(replaced(action, value=value) if known else action)
            self._assigned(action.target.channel, value)
            return
        self._do(action)
        for name in channels_written(action):
            self._assigned(name, None, surely=False)

    def _assigned(self, name: str, value: Expression | None, *, surely: bool = True) -> None:
        if surely:
            self._written.add(name)
        if name in self._counting and isinstance(value, LiteralValue):
            self._known[name] = value
        else:
            self._known.pop(name, None)

    def _variable(self, name: str, kind: Type, offer: Offer | None = None) -> str:
        """An additional variable; one for each place that makes offers."""
        key = (name, None if offer is None else (*offer.place.key, offer.place.position, offer.number))
        if key not in self._names:
            number = 1
            unique = name
            while unique in self._types or unique in self.made:
                number += 1
                unique = f"{name}_{number}"
            self._names[key] = unique
            self.made[unique] = kind
        return self._names[key]

    def _assign(self, span: Span, target: ir.Target, value: Expression) -> None:
        self._do(ir.AssignValue(span=span, target=target, value=value))
        self._assigned(target.channel, self.folded(value))

    def communicate(self, channel: str, value: Expression, offer: Offer) -> None:
        """A value is passed to the target of an offer."""
        stored = self._store(channel, offer, value)
        self._do(ir.ReportCommunication(span=offer.span, channel=channel, value=stored))

    def give(self, offer: Offer, value: Expression) -> None:
        """A buffered value is passed to the target of an offer."""
        self._store(offer.medium.name, offer, value)

    def _store(self, channel: str, offer: Offer, value: Expression) -> Expression:
        """Store a value in the target of an offer; the index of an array element is computed when the reader
        continues.
        """
        target = offer.target
        assert target is not None
        # The reader may wait longer than the writer, whose value is then computed here; a fault is the writer's.
        span = value.span if value.span is not None and may_fault(value) else offer.span
        if not target.indexes:
            self._assign(span, target, value)
            return VariableValue(type=self._types[target.channel], channel=target.channel)
        name = self._variable(f"{channel}.taken", self._types[channel], offer)
        self._assign(span, ir.Target(name), value)
        taken = VariableValue(type=self._types[channel], channel=name)
        self._postponed.setdefault(offer.place.key, []).append(
            ir.AssignValue(span=offer.span, target=target, value=taken)
        )
        return taken

    def forget(self, task: object) -> None:
        """A task has ended."""
        self._postponed.pop(task, None)

    def resumed(self, task: object) -> None:
        """A task continues after a communication."""
        for action in self._postponed.pop(task, ()):
            self.compute_action(action)

    def keep(self, offer: Offer, slot: int) -> Expression:
        """The value of a writer enters a buffer; returns the expression that then represents it."""
        channel = offer.medium.name
        kind = self._types[channel]
        assert offer.value is not None
        name = self._variable(f"{channel}.value_{slot}", kind)
        self._assign(offer.span, ir.Target(name), offer.value)
        kept = VariableValue(type=kind, channel=name)
        self._do(ir.ReportCommunication(span=offer.span, channel=channel, value=kept))
        return kept

    def sample(self, offer: Offer, fresh: bool) -> None:
        """A sample is taken; ``fresh`` if it arrived at this instant."""
        assert offer.target is not None
        self._do(ir.ReadValue(span=offer.span, source=offer.source, target=offer.target), fresh=fresh)
        self._assigned(offer.target.channel, None, surely=not offer.target.indexes)

    def at_once(self, offer: Offer) -> None:
        """A variable is read, or it or an output is written."""
        if offer.value is None:
            assert isinstance(offer.source, ir.ChannelEnd)
            assert offer.target is not None
            value = VariableValue(type=self._types[offer.source.channel], channel=offer.source.channel)
            self.compute_action(ir.AssignValue(span=offer.span, target=offer.target, value=value))
        elif isinstance(offer.source, ir.ChannelEnd):
            self._assign(offer.span, ir.Target(offer.source.channel), offer.value)
        else:
            self._do(ir.WriteValue(span=offer.span, sink=offer.source, value=offer.value))

    def compute(self, offer: Offer) -> None:
        """The value of a writer is computed before it waits, unless it would be the same later."""
        value = offer.value
        assert value is not None
        match value:
            case LiteralValue() | ParameterValue():
                return
            case VariableValue(channel=channel) if channel in self._written:
                return
        self._compute(offer, value)

    def compute_in_advance(self, offer: Offer) -> None:
        """The value of one of several offers is computed before any of them is made, unless it cannot fault."""
        value = offer.value
        assert value is not None
        match value:
            case LiteralValue() | ParameterValue() | SignalValue():
                return
            case VariableValue(channel=channel) if channel in self._written:
                return
        self._compute(offer, value)

    def _compute(self, offer: Offer, value: Expression) -> None:
        kind = value.type
        name = self._variable(f"{offer.medium.name}.offered", kind, offer)
        self._assign(offer.span, ir.Target(name), value)
        offer.value = VariableValue(type=kind, channel=name)
