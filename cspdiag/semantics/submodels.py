"""Control laws in processes: instances of submodels, and laws that the optimizer has inlined."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from cspdiag.network.ir import actions as act
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import Connection, ConstantEnd, DiscardEnd, ProcessClass, SubmodelClass
from cspdiag.semantics.equations.laws import Law
from cspdiag.semantics.media import EndKey, Medium, Offer, Place
from cspdiag.semantics.requests import Communicate, Steps
from cspdiag.semantics.values import Names, fitting, value_of


class Owner(Protocol):
    """The process around a submodel. «The communication diagram»"""

    path: str

    def key(self, end: act.End) -> EndKey:
        """The end as one of this process, or of one that was flattened into this one."""

    def attached(self, connection: Connection) -> Medium:
        """The medium that a port of an instance inside is attached to."""


class SubmodelInstance:
    """A submodel that communicates through the ends of the process that encloses it. «Submodels: the control laws»"""

    def __init__(
        self,
        owner: Owner,
        cls: SubmodelClass,
        parameters: Mapping[str, Any],
        connections: tuple[Connection, ...],
    ) -> None:
        assert cls.external is None, "bodies in other languages have no specification"
        self.owner = owner
        self.cls = cls
        self.law = Law(cls, parameters)
        self.joined: dict[Place, tuple[Medium, EndKey]] = {}
        for connection in connections:
            end = connection.attachment
            key: EndKey = (owner.path, "", None, 0) if isinstance(end, ConstantEnd | DiscardEnd) else owner.key(end)
            self.joined[connection.port, connection.index] = (owner.attached(connection), key)

    def _places(self, direction: str) -> Iterator[tuple[str, Place]]:
        for port in self.cls.ports:
            if port.direction == direction:
                yield from ((port.name, place) for place in self.joined if place[0] == port.name)

    def run(self) -> Steps:
        """Offer all inputs at once, compute one sample, offer all outputs at once.

        «Submodels: the control laws», «Parallel»
        """
        reading = Communicate()
        names = []
        for name, place in self._places("in"):
            medium, key = self.joined[place]
            names.append(name if place[1] is None else f"{name}[{place[1]}]")
            reading.offers.append(Offer(reading, medium, key, writes=False))
        values = yield reading
        signals = self.law.sample(**dict(zip(names, values, strict=True)))
        writing = Communicate()
        for name, place in self._places("out"):
            medium, key = self.joined[place]
            kind = next(port.type for port in self.cls.ports if port.name == name)
            value = fitting(kind, signals[name if place[1] is None else f"{name}[{place[1]}]"])
            writing.offers.append(Offer(writing, medium, key, writes=True, value=value))
        yield writing


class InlinedLaws:
    """The constants, states and local signals of the control laws that were inlined into a process.

    «Submodels: the control laws»
    """

    def __init__(self, cls: ProcessClass, parameters: Mapping[str, Any], variables: Names) -> None:
        self.parameters = parameters
        self.variables = variables
        self.values: dict[str, Any] = {}
        self.initial = {state.name: state.initial for state in cls.states}
        for constant in cls.constants:
            self.values[constant.name] = self._value(constant.value)
        self.reset(tuple(self.initial))

    def _value(self, expression: Expression) -> Any:
        return value_of(expression, self.parameters, self.variables, self.values.__getitem__)

    def reset(self, states: tuple[str, ...]) -> None:
        """Put states back to their initial values. «The composition diagram»"""
        for name in states:
            self.values[name] = self._value(self.initial[name])

    def run(self, action: act.RunLaw) -> None:
        """Run a law once: the local signals, and then the next states. «Submodels: the control laws»"""
        law = Law(_as_submodel(action), self.parameters, self.variables)
        law.constants = self.values
        signals = law.evaluate()
        law.advance(signals, 0.0 if action.sample is None else self._value(action.sample))
        self.values |= {**signals, **law.states}


def _as_submodel(action: act.RunLaw) -> SubmodelClass:
    return SubmodelClass(
        name=action.law,
        span=action.span,
        definition=action.law,
        equations=action.equations,
        next_values=action.next_values,
        derivative_equations=action.derivative_equations,
        derivatives=action.derivatives,
        method=action.method,
        step=action.step,
    )
