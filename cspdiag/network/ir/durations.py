"""Bounds of the durations of delays: which delays certainly let time pass.

A delay with a zero or negative duration is over at once. The bounds are computed by interval arithmetic from
parameters, with the values that all instances give them, and from variables, with all values that are ever assigned to
them.
"""

from __future__ import annotations

from cspdiag.network.ir.actions import AssignValue, InputEvent, ReadValue
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, VariableValue
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.ranges import ExpressionInput, Range, joined, limits_of, of_instances, value_range
from cspdiag.network.ir.walk import parts

_DEEPEST = 4
"""The greatest depth to which variables that are computed from each other are followed."""


class Durations:
    """The durations of the delays in a network, by the class that contains them."""

    def __init__(self, network: Network) -> None:
        self._classes = {entry.name: entry for entry in network.classes}
        class_of = {instance.path: instance.class_name for instance in network.instances}
        owned = ((net.path.rpartition("."), net) for net in network.nets)
        self._given_by_others = {
            (class_of.get(owner), name) for (owner, _, name), net in owned if net.writers or net.external is not None
        }
        self._variables: dict[tuple[str, str], Range] = {}

    def surely_takes_time(self, class_name: str, duration: Expression) -> bool:
        """Whether a delay lasts longer than zero in every instance of the class, whenever it begins."""
        return self._bounds(class_name, duration, frozenset())[0] > 0

    def is_over_at_once(self, class_name: str, duration: Expression) -> bool:
        """Whether the duration of a delay is zero or negative in every instance of the class."""
        return self._bounds(class_name, duration, frozenset())[1] <= 0

    def _bounds(self, name: str, expression: Expression, assumed: frozenset[str]) -> Range:
        """The values that an expression may have. ``assumed`` are variables that are taken to be greater than zero."""

        def known(part: ExpressionInput) -> Range | None:
            if isinstance(part, VariableValue) and part.range is None:
                return self._of_variable(name, part, assumed)
            return of_instances(part)

        return value_range(expression, known)

    def _of_variable(self, name: str, variable: VariableValue, assumed: frozenset[str]) -> Range:
        """The range of a variable: if all values assigned to it are greater than zero provided that it was so before,
        it always is.
        """
        limits = limits_of(variable.type)
        if variable.channel in assumed:
            return 1, limits[1]
        known = self._variables.get((name, variable.channel))
        if known is not None:
            return known
        given = self._given(name, variable.channel)
        if given is None or len(assumed) == _DEEPEST:
            return limits
        inside = assumed | {variable.channel}
        found = joined(self._bounds(name, value, inside) for value in given)
        if found[0] < 1 and any(isinstance(part, VariableValue) for value in given for part in walk(value)):
            found = limits
        if not assumed:
            self._variables[name, variable.channel] = found
        return found

    def _given(self, name: str, variable: str) -> list[Expression] | None:
        """The initial value and all assigned values of a variable; None if it also gets values from other instances or
        communications.
        """
        entry = self._classes[name]
        if not isinstance(entry, ProcessClass) or (name, variable) in self._given_by_others:
            return None
        initial = (channel.initial for channel in entry.channels if channel.name == variable)
        found = [value for value in initial if value is not None]
        for part in parts(entry.body):
            match part:
                case AssignValue(target=target, value=value) if target.channel == variable:
                    found.append(value)
                case ReadValue(target=target) | InputEvent(target=target) if target.channel == variable:
                    return None
        return found or None
