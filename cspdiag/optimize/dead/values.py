"""Removes equations, states and assignments of a process whose values are not used.

A value is used if a communication, a condition, a delay or another used value needs it, or if computing it can fault: a
fault is an effect. A continuous state may always become infinite, which is a fault, so integrations stay.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeAlias

from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import AssignValue, ChannelEnd, ResetStates, RunLaw, SequentialSteps, SkipStep
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import Expression, SignalValue, Typed, VariableValue
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import inner_parts, parts
from cspdiag.optimize.changes import changed, in_sequence

Name: TypeAlias = "tuple[type[SignalValue] | type[VariableValue], str]"


def without_dead_values(entry: ProcessClass, unwritten: frozenset[str]) -> ProcessClass:
    """The class without dead values; variables that are left without any use stay for the caller to remove.

    ``unwritten`` are the variables that may be read before they are written, which is a fault.
    """
    values = _Values(entry, unwritten)
    used = values.used
    live = tuple(s for s in entry.states if (SignalValue, s.name) in used or values.may_fault(s.initial))
    dead = {state.name for state in entry.states} - {state.name for state in live}

    def change(item: Any) -> Any:
        match item:
            case RunLaw():
                return _live_part(item, values)
            case AssignValue() if (VariableValue, item.target.channel) not in used and not values.has_effect(item):
                return SkipStep(span=item.span)
            case ResetStates():
                states = tuple(name for name in item.states if name not in dead)
                return changed(item, states=states) if states else SkipStep(span=item.span)
            case SequentialSteps() if any(isinstance(step, SkipStep) for step in item.steps):
                return in_sequence(item.steps, item)
            case _:  # Any other part is unchanged.
                return item

    return replaced(
        entry,
        body=rewritten(entry.body, change),
        constants=tuple(c for c in entry.constants if (SignalValue, c.name) in used or values.may_fault(c.value)),
        states=live,
    )


def _live_part(law: RunLaw, values: _Values) -> RunLaw | SkipStep:
    def is_live(name: str, value: Expression) -> bool:
        return (SignalValue, name) in values.used or values.may_fault(value)

    live = replaced(
        law,
        equations=tuple(e for e in law.equations if isinstance(e, ExternalCall) or is_live(e.name, e.value)),
        next_values=tuple(item for item in law.next_values if is_live(*item)),
    )
    if not (live.equations or live.next_values or live.derivatives):
        return SkipStep(span=law.span)
    return live


class _Values:
    """The signals and variables of a class that are ``used``, collected from everything that has an effect until
    nothing is added.
    """

    def __init__(self, entry: ProcessClass, unwritten: frozenset[str]) -> None:
        self.used: set[Name] = set()
        self._unwritten = unwritten
        self._needs: dict[Name, list[Any]] = {}
        for constant in entry.constants:
            self._need(constant.name, constant.value)
        for state in entry.states:
            self._need(state.name, state.initial)
        for part in parts(entry.body):
            if isinstance(part, RunLaw):
                self._note_law(part)
            elif isinstance(part, AssignValue):
                self._needs.setdefault((VariableValue, part.target.channel), []).append(part)
        pending = [*self._effects((entry.body, entry.channels))]
        for instance in entry.instances:
            if instance.arguments:
                pending += self._effects(instance.arguments)
            for connection in instance.connections:
                attachment = connection.attachment
                if isinstance(attachment, ChannelEnd):
                    pending += self._used(VariableValue, attachment.channel)
                else:
                    pending += self._effects(attachment)
        pending += [item.value for item in entry.constants if self.may_fault(item.value)]
        pending += [item.initial for item in entry.states if self.may_fault(item.initial)]
        while pending:
            for kind, name in _names(pending.pop()):
                pending += self._used(kind, name)

    def _used(self, kind: type[SignalValue] | type[VariableValue], name: str) -> Sequence[Any]:
        """Notes that a signal or a variable is used; what its value depends on, if that is new."""
        if (kind, name) in self.used:
            return ()
        self.used.add((kind, name))
        return self._needs.get((kind, name), ())

    def _need(self, name: str, value: Any) -> None:
        self._needs.setdefault((SignalValue, name), []).append(value)

    def _note_law(self, law: RunLaw) -> None:
        for equation in law.equations:
            if isinstance(equation, SubmodelEquation):
                self._need(equation.name, equation.value)
        for name, value in law.next_values:
            self._need(name, value)

    def may_fault(self, expression: Expression) -> bool:
        """Whether computing the expression may fault, including by a read of an unwritten variable."""
        variables = (part.channel for part in parts(expression) if isinstance(part, VariableValue))
        return may_fault(expression) or any(name in self._unwritten for name in variables)

    def has_effect(self, item: AssignValue) -> bool:
        """Whether an assignment may fault."""
        return bool(item.target.indexes) or self.may_fault(item.value)

    def _effects(self, item: Any) -> Iterator[Any]:
        """What is needed in any case; values that are only stored are not, unless computing them may fault."""
        pending = [item]
        while pending:
            part = pending.pop()
            if isinstance(part, RunLaw):
                yield from self._effects_of_law(part)
            elif isinstance(part, AssignValue):
                if self.has_effect(part):
                    yield part
            elif isinstance(part, Typed) or type(part) is ChannelEnd:
                yield part
            else:
                pending += inner_parts(part)

    def _effects_of_law(self, law: RunLaw) -> Iterable[Any]:
        for equation in law.equations:
            if isinstance(equation, ExternalCall):
                yield equation
            elif self.may_fault(equation.value):
                yield equation.value
        for name, value in law.next_values:
            if self.may_fault(value):
                yield SignalValue(type=value.type, name=name)
        # Each stage of the integration computes these values again, and does not read those from before it.
        again = {equation.name for equation in law.derivative_equations}
        for part in parts((law.derivative_equations, law.derivatives)):
            if isinstance(part, _READ) and not (isinstance(part, SignalValue) and part.name in again):
                yield part
        yield from (SignalValue(type=d.type, name=name) for name, d in law.derivatives)
        if law.sample is not None:
            yield law.sample


_READ = (SignalValue, VariableValue, ChannelEnd)


def _names(item: Any) -> Iterator[Name]:
    """The signals and variables that are read; an end of a variable counts as a read, and so does an assignment to one
    element.
    """
    for part in parts(item):
        match part:
            case SignalValue():
                yield SignalValue, part.name
            case VariableValue():
                yield VariableValue, part.channel
            case ChannelEnd():
                yield VariableValue, part.channel
            case _:  # Any other part has no name that is read.
                pass
