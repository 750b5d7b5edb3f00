"""The environment: the model of the plant and everything else around the program, from instant to instant."""

from __future__ import annotations

from typing import Any

from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import Environment
from cspdiag.semantics.laws import Law
from cspdiag.semantics.values import zero


class Plant:
    """The environment as one system of equations, made from all its instances. «The environment from instant to
    instant»
    """

    def __init__(self, environment: Environment) -> None:
        assert environment.system is not None
        assert not environment.drivers, "devices have no specification"
        self.grid = Sampling(environment.step)
        self.law = Law(environment.system, {})
        self.inputs = {port.name: zero(port.type) for port in environment.system.ports if port.direction == "in"}
        self.now = 0
        self.signals: dict[str, Any] = {}

    def start(self) -> None:
        """Evaluate at time 0. «The environment from instant to instant»"""
        self.signals = self.law.evaluate(**self.inputs)

    def advance(self, now: int) -> None:
        """Steps 1 to 4: evaluate, compute ``next`` on the grid, integrate with the inputs held, evaluate again.

        «The environment from instant to instant»
        """
        signals = self.law.evaluate(**self.inputs)
        self.law.advance(signals, (now - self.now) / 1e9, discrete=self.grid.is_tick(now))
        self.now = now
        self.law.time = now / 1e9
        self.signals = self.law.evaluate(**self.inputs)

    def output(self, port: str) -> Any:
        """The present value of an output."""
        return self.signals[port]

    def give(self, port: str, value: Any) -> None:
        """Takes a new value of an output of the program."""
        self.inputs[port] = value
