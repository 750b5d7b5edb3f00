"""A system of equations while it is assembled from submodels."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.types import RealType, Type
from cspdiag.model.units import SECOND
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, SignalValue, Value
from cspdiag.network.ir.network import ClassParameter, SubmodelState
from cspdiag.network.submodels.discretize import Method

SECONDS = RealType(unit=SECOND)


@node
class LinearOperator:
    """A transfer function or a state space whose coefficients are to be computed for the sample period.

    ``matrices`` are (numerator, denominator) or (A, B, C, D); ``coefficients`` are the names and types of the
    parameters whose values discretization computes, in its order.
    """

    matrices: tuple[Expression, ...]
    method: Method
    coefficients: tuple[tuple[str, Type], ...]
    span: Span


class Draft:
    """A system under construction. Names are unique among parameters, inputs, equations and states.

    ``owner`` is the span for what the compiler adds; ``sample`` is the period in nanoseconds, if known; ``arguments``
    are the values of the parameters. ``concrete``: all arguments are known, as for an instance; otherwise a definition
    is checked by itself. ``closed``: no instance provides values, so derived parameters are constants (an environment).
    ``overrides`` are values set from outside for parameters of nested instances, by path (``pan.inertia``). ``tunable``
    are the parameters that follow parameters of the program.
    """

    def __init__(
        self,
        *,
        owner: Span,
        sample: int | None,
        arguments: Mapping[str, Value],
        concrete: bool = True,
        closed: bool = False,
        overrides: Mapping[str, Value] | None = None,
        tunable: frozenset[str] = frozenset(),
    ) -> None:
        self.owner = owner
        self.sample = sample
        self.arguments = arguments
        self.concrete = concrete
        self.closed = closed
        self.overrides = overrides or {}
        self.tunable = tunable
        self.names: set[str] = set()
        self.parameters: dict[str, ClassParameter] = {}
        self.derived: dict[str, Value] = {}
        self.equations: dict[str, SubmodelEquation | ExternalCall] = {}
        self.states: dict[str, SubmodelState] = {}
        self.next_values: dict[str, Expression] = {}
        self.derivatives: dict[str, Expression] = {}
        self.changes: dict[str, Span] = {}
        """Where next values and derivatives are given."""
        self.linear_operators: list[LinearOperator] = []
        self.held: set[str] = set()
        """Outputs of discrete operators, which keep their value over the sub-steps of an integration."""
        self.written: dict[str, str] = {}
        """The text of each operator whose output the compiler has named."""
        self.kept: set[str] = set()
        """Signals of a closed system that are kept even if no other signal needs them."""
        self.methods: list[str] = []
        self.steps: list[int] = []
        self.complete = True
        """Whether no errors were reported in any definition used."""
        self.depends = False
        """Whether a size or an initial value was computed that depends on the values of parameters."""
        self.decisive: set[str] = set()
        """Signals whose values have become a part of the system: a size, an index, a step, a coefficient."""
        self._values: dict[str, Value | None] = {}

    def unique(self, name: str) -> str:
        """``name``, with a number appended if it is taken; marks the result as taken."""
        chosen, number = name, 2
        while chosen in self.names:
            chosen, number = f"{name}_{number}", number + 1
        self.names.add(chosen)
        return chosen

    def equation(
        self, name: str, value: Expression, span: Span, doc: str | None = None, kind: Type | None = None
    ) -> None:
        """Defines a signal; ``kind`` is its type if that is not the type of ``value``."""
        self.equations[name] = SubmodelEquation(name=name, type=kind or value.type, value=value, span=span, doc=doc)

    def signal(self, name: str, kind: Type, span: Span | None = None) -> SignalValue:
        """The value of a signal."""
        return SignalValue(type=kind, name=name, span=span)

    def sample_period(self) -> Expression:
        """The sample period in seconds, which becomes a parameter of the system."""
        value = None if self.sample is None else self.sample / 1_000_000_000
        return self.derived_parameter("sample", SECONDS, value)

    def derived_parameter(self, name: str, kind: Type, value: Value | None) -> Expression:
        """A parameter whose value the compiler provides, now or, if ``value`` is None, later."""
        if self.closed:
            if name not in self.equations:
                self.equation(name, LiteralValue(type=kind, value=0.0 if value is None else value), self.owner)
            return self.signal(name, kind)
        if name not in self.parameters:
            self.parameters[name] = ClassParameter(name=name, type=kind, derived=True, span=self.owner)
            if value is not None:
                self.derived[name] = value
        return ParameterValue(type=kind, name=name)

    def give(self, name: str, kind: Type, value: Value) -> None:
        """Sets the value of a derived parameter."""
        if self.closed:
            self.equation(name, LiteralValue(type=kind, value=value), self.owner)
        else:
            self.derived[name] = value

    def value_of(self, expression: Expression) -> Value | None:
        """The value of a constant expression, which decides what the system is; None while it is not known."""
        self.decisive.update(signals_read(expression))
        return self.probed(expression)

    def probed(self, expression: Expression) -> Value | None:
        """The value of a constant expression, of which matters only whether it can be computed and is finite; None if
        it is not known.
        """
        return constant_value(expression, self._lookup)

    def _lookup(self, name: ParameterValue | SignalValue) -> Value | None:
        if isinstance(name, ParameterValue):
            return self.arguments.get(name.name, self.derived.get(name.name))
        if name.name in self._values:
            return self._values[name.name]
        equation = self.equations.get(name.name)
        if not isinstance(equation, SubmodelEquation):
            return None
        # If the name occurs again in its own value, that is a loop, which is reported elsewhere.
        self._values[name.name] = None
        value = self._values[name.name] = self.probed(equation.value)
        if value is None:
            del self._values[name.name]
        return value
