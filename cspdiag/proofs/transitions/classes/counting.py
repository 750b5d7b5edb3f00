"""Which 64-bit integers and times are counters: every value that one of them gets is a constant, the present time, or
an earlier value of a counter with little added or subtracted.

Before they are so far from zero that a sum of two overflows, more than five hundred million steps have been counted, or
eighteen years of the program's own time have passed: no proof follows a run that far. Of all other variables nothing is
known: an input may have any value, and a value that is doubled overflows after 63 iterations.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.model.types import IntType, TimeType, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    ConditionalValue,
    Expression,
    FunctionCall,
    ParameterValue,
    PresentTime,
    SignalValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.network import (
    Attachment,
    ConstantEnd,
    CoreClass,
    CoreNetwork,
    DiscardEnd,
    ProcessClass,
    SubmodelClass,
    SubmodelState,
)
from cspdiag.network.ir.ranges import ExpressionInput, Lookup, Range, of_instances, value_range
from cspdiag.network.ir.walk import parts

_STEP = 2**31
"""Counters are increased and decreased by less than this: as a time, 2.1 s."""

_BASE = 2**60
"""Counters begin nearer to zero than this."""

_COUNTED = (-(2**61), 2**61)
"""A counter then stays within these limits for 2**60 / 2**31 computations."""

_PRESENT = (0, 2**59)
"""The present time for 18 years, in nanoseconds."""

_LONGEST_DELAY = 2**46
"""Delays that are longer than this, 19 h, could reach the end of the program's time in few steps."""

_Place: TypeAlias = tuple[str, str]
"""The names of a class, and of a port, channel or variable of it, or of a signal if it is a control law."""

_NOW: _Place = ("", "")
"""The present time, among the places."""


@record
class _Value:
    """The value of an expression in terms of a class."""

    expression: Expression
    class_name: str


_Origin: TypeAlias = "_Place | _Value"
"""Where a value comes from."""


class Counting:
    """The counters of a network: everything that is not shown to get any other value."""

    def __init__(self, network: CoreNetwork) -> None:
        self._origins = _origins(network)
        self._delays = list(_delays(network))
        unknown = {place for place, origin in self._origins if origin is None}
        self._counting = {place for place, _ in self._origins} - unknown
        if _periods_are_short(network):
            self._counting.add(_NOW)
        self._remove_others()

    def ranges_in(self, class_name: str, *, counted: bool = True) -> Lookup:
        """The ranges of the values in expressions of a class; None where nothing is known. Unless ``counted``, nothing
        is taken to be known of variables.
        """

        def known(part: ExpressionInput) -> Range | None:
            match part:
                case ParameterValue():
                    return of_instances(part)
                case VariableValue(range=(_, _)):
                    return of_instances(part)
                case PresentTime():
                    return _PRESENT if _NOW in self._counting else None
                case VariableValue(channel=name) | SignalValue(name=name):
                    return _COUNTED if counted and (class_name, name) in self._counting else None
                case _:
                    assert_never(part)

        return known

    def _remove_others(self) -> None:
        """Removes what gets a value from anything that is not a counter, until nothing changes."""
        changed = True
        while changed:
            others = {
                place
                for place, origin in self._origins
                if place in self._counting and not (origin is not None and self._comes_from_counting(origin))
            }
            if _NOW in self._counting and not all(
                self._is_near(delay.expression, delay.class_name) for delay in self._delays
            ):
                others.add(_NOW)
            self._counting -= others
            changed = bool(others)

    def _comes_from_counting(self, origin: _Origin) -> bool:
        if isinstance(origin, _Value):
            return self._counts(origin.expression, origin.class_name)
        return origin in self._counting

    def _counts(self, value: Expression, class_name: str) -> bool:
        """Whether a value is near zero, or that of a counter with little added or subtracted."""
        if self._within(value, class_name, _BASE, counted=False):
            return True
        match value:
            case VariableValue(channel=name) | SignalValue(name=name):
                return (class_name, name) in self._counting
            case UnaryOperation(operator="-", operand=operand):
                return self._counts(operand, class_name)
            case BinaryOperation(operator="+" | "-", left=left, right=right):
                return self._counts_by(left, right, class_name) or self._counts_by(right, left, class_name)
            case ConditionalValue(then=then, otherwise=otherwise):
                return self._counts(then, class_name) and self._counts(otherwise, class_name)
            case FunctionCall(function="abs" | "min" | "max" | "limit", arguments=arguments):
                return all(self._counts(argument, class_name) for argument in arguments)
            case _:  # Products, elements, what a function computes: of them only the range is known.
                return False

    def _counts_by(self, value: Expression, step: Expression, class_name: str) -> bool:
        return self._within(step, class_name, _STEP, counted=True) and self._counts(value, class_name)

    def _is_near(self, duration: Expression, class_name: str) -> bool:
        """Whether a delay is short, or lasts until an instant that is near the value of a counter."""
        match duration:
            case FunctionCall(function="until", arguments=(instant, _)):
                return self._within(instant, class_name, 2 * _COUNTED[1], counted=True)
            case _:  # Any other duration is counted from where it begins.
                return self._within(duration, class_name, _LONGEST_DELAY, counted=True)

    def _within(self, value: Expression, class_name: str, limit: int, *, counted: bool) -> bool:
        """Whether a value is nearer to zero than a limit, whatever its variables are, or with counters within their
        limits if ``counted``.
        """
        low, high = value_range(value, self.ranges_in(class_name, counted=counted))
        return -limit < low and high < limit


def is_wide(kind: Type) -> bool:
    """Whether a type has 64 bits, so a counter does not reach its limits."""
    return isinstance(kind, TimeType) or (isinstance(kind, IntType) and kind.bits == 64)


def _origins(network: CoreNetwork) -> list[tuple[_Place, _Origin | None]]:
    """Every place of a 64-bit integer or a time, with each origin of its values; None means any value."""
    inputs = {(entry.name, port.name) for entry in network.classes for port in entry.ports if port.direction == "in"}
    found: list[tuple[_Place, _Origin | None]] = [(place, None) for place in inputs if place[0] == network.top]
    wide: set[_Place] = set()
    for entry in network.classes:
        typed = [*entry.ports, *(entry.channels if isinstance(entry, ProcessClass) else _signals_in(entry))]
        wide |= {(entry.name, one.name) for one in typed if is_wide(one.type)}
        if entry.external is not None:
            found += [((entry.name, port.name), None) for port in entry.ports]
        elif isinstance(entry, ProcessClass):
            found += [*_origins_in(entry), *_connected(entry, inputs)]
        else:
            found += _origins_in_law(entry)
    return [(place, origin) for place, origin in found if place in wide]


def _signals_in(law: SubmodelClass) -> list[SubmodelState | SubmodelEquation]:
    """The named values of a control law, except those that code in another language computes."""
    return [*law.states, *law.constants, *(one for one in law.equations if isinstance(one, SubmodelEquation))]


def _origins_in_law(law: SubmodelClass) -> Iterator[tuple[_Place, _Origin]]:
    for state in law.states:
        yield (law.name, state.name), _Value(state.initial, law.name)
    for name, value in law.next_values:
        yield (law.name, name), _Value(value, law.name)
    for signal in _signals_in(law):
        if isinstance(signal, SubmodelEquation):
            yield (law.name, signal.name), _Value(signal.value, law.name)


def _origins_in(entry: CoreClass) -> Iterator[tuple[_Place, _Origin | None]]:
    for channel in entry.channels:
        if channel.initial is not None:
            yield (entry.name, channel.name), _Value(channel.initial, entry.name)
    for part in parts(entry.body):
        match part:
            case ir.AssignValue(target=target, value=value):
                yield (entry.name, target.channel), _Value(value, entry.name)
            case ir.ReadValue(source=source, target=target) | ir.InputEvent(source=source, target=target):
                yield (entry.name, target.channel), _origin_of(source, entry.name)
            case ir.WriteValue(sink=sink, value=value) | ir.OutputEvent(sink=sink, value=value):
                yield _place_of(sink, entry.name), _Value(value, entry.name)
            case _:  # Nothing else gives a variable a value.
                pass


def _connected(entry: CoreClass, inputs: set[tuple[str, str]]) -> Iterator[tuple[_Place, _Origin | None]]:
    """Where the inputs of instances in a class get their values, and which places get the values of their outputs."""
    for instance in entry.instances:
        for connection in instance.connections:
            inner: _Place = (instance.class_name, connection.port)
            if (instance.class_name, connection.port) in inputs:
                yield inner, _origin_of(connection.attachment, entry.name)
            elif isinstance(connection.attachment, ir.PortEnd | ir.ChannelEnd):
                yield _place_of(connection.attachment, entry.name), inner


def _origin_of(end: Attachment, class_name: str) -> _Origin | None:
    match end:
        case ir.PortEnd() | ir.ChannelEnd():
            return _place_of(end, class_name)
        case ConstantEnd(value=value):
            return _Value(value, class_name)
        case DiscardEnd():
            return None
        case _:
            assert_never(end)


def _place_of(end: ir.End, class_name: str) -> _Place:
    return (class_name, end.port) if isinstance(end, ir.PortEnd) else (class_name, end.channel)


def _delays(network: CoreNetwork) -> Iterator[_Value]:
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            for part in parts(entry.body):
                if isinstance(part, ir.WaitStep | ir.AfterEvent):
                    yield _Value(part.duration, entry.name)


def _periods_are_short(network: CoreNetwork) -> bool:
    return all(port.sampling is None or port.sampling.period < _LONGEST_DELAY for port in network.external_ports)
