"""The environment: the model of the plant and everything else around the program, from instant to instant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.network import Environment, SubmodelClass
from cspdiag.semantics.equations.laws import Law
from cspdiag.semantics.values import Cell, zero


class Plant:
    """The environment as one system of equations, made from all its instances. «The environment from instant to
    instant»
    """

    def __init__(self, environment: Environment, parameters: Mapping[str, Cell]) -> None:
        assert environment.system is not None
        assert not environment.drivers, "devices have no specification"
        self.grid = Sampling(environment.step)
        self.law = Law(environment.system, parameters)
        self.inputs = {port.name: zero(port.type) for port in environment.system.ports if port.direction == "in"}
        self.results = [port.name for port in environment.system.ports if port.direction == "out"]
        self.changes = _read_by_changes(environment.system)
        self.now = 0
        self.signals: dict[str, Any] = {}

    def start(self) -> None:
        """Evaluate the outputs at time 0, with what parameters are after the changes of that instant. «The environment
        from instant to instant»
        """
        self.law.reset()
        self.signals = self.law.evaluate(self.results, **self.inputs)

    def advance(self, now: int) -> None:
        """Steps 1 to 4: evaluate, compute ``next`` on the grid, integrate with the inputs held, evaluate again.

        «The environment from instant to instant»
        """
        signals = self.law.evaluate(self.changes, **self.inputs)
        self.law.advance(signals, (now - self.now) / 1e9, discrete=self.grid.is_tick(now))
        self.now = now
        self.law.time = now / 1e9
        self.signals = self.law.evaluate(self.results, **self.inputs)

    def output(self, port: str) -> Any:
        """The present value of an output."""
        return self.signals[port]

    def give(self, port: str, value: Any) -> None:
        """Takes a new value of an output of the program."""
        self.inputs[port] = value


def _read_by_changes(law: SubmodelClass) -> frozenset[str]:
    """The signals that ``next`` values read, and those that derivatives read but do not compute in each stage."""
    computed = {equation.name for equation in law.derivative_equations}
    slopes = [*(equation.value for equation in law.derivative_equations), *(value for _, value in law.derivatives)]
    held = {name for value in slopes for name in signals_read(value)} - computed
    return frozenset(held.union(*(signals_read(value) for _, value in law.next_values)))
