"""Submodels: their equations, evaluated in order, and their discrete and continuous states."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.semantics.equations.linear import Linear, linear, rk4
from cspdiag.semantics.values import FaultError, Names, fitting, value_of


def _no_variable(name: str) -> Any:
    raise AssertionError(f"a control law has no variable {name}")


class Law:
    """One instance of a submodel. ``parameters`` has values for all parameters, including derived ones.

    «Submodels: the control laws»

    ``variables`` looks up the variables of the process that the submodel was inlined into, if it was; ``externals`` are
    bodies in other languages, by name.
    """

    def __init__(
        self,
        cls: SubmodelClass,
        parameters: Mapping[str, Any],
        variables: Names = _no_variable,
        externals: Mapping[str, Any] | None = None,
    ) -> None:
        self.cls = cls
        self.parameters = dict(parameters)
        self.variables = variables
        self.externals = dict(externals or {})
        self.time = 0.0
        self.constants: dict[str, Any] = {}
        for constant in cls.constants:
            self.constants[constant.name] = self.value(constant.value, self.constants)
        self.states: dict[str, Any] = {}
        self.reset()

    def reset(self) -> None:
        """Put the states back to their initial values: ``reset name``. «The composition diagram»"""
        for state in self.cls.states:
            self.states[state.name] = self.value(state.initial, self.constants)

    def evaluate(self, only: Collection[str] | None = None, /, **inputs: Any) -> dict[str, Any]:
        """All signals at the present instant, equations in the order in which they depend on each other; ``only`` those
        that some signals depend on.

        «Submodels: the control laws»
        """
        signals = {**self.constants, **inputs, **self.states}
        for equation in self.cls.equations if only is None else _needed(self.cls.equations, only):
            if isinstance(equation, ExternalCall):
                given = {name: self.value(value, signals) for name, value in equation.inputs}
                results = self.externals[equation.name](**given)
                results = results if isinstance(results, tuple) else (results,)
                for (_, local, _), result in zip(equation.outputs, results, strict=True):
                    signals[local] = result
            else:
                signals[equation.name] = self.value(equation.value, signals)
        return signals

    def advance(self, signals: dict[str, Any], duration: float, *, discrete: bool = True) -> None:
        """Advance from one sample to the next.

        All next values are computed before any of them takes effect; continuous states are integrated over
        ``duration``, in seconds. «Submodels: the control laws»
        """
        following = {name: self.value(value, signals) for name, value in self.cls.next_values} if discrete else {}
        if self.cls.derivatives:
            for moved, value in self._integrated(signals, duration).items():
                following[moved] = _finite(value)
        self.states.update(following)
        self.time += duration

    def sample(self, /, **inputs: Any) -> dict[str, Any]:
        """All signals after one run of a sampled submodel, with the inputs held. «Submodels: the control laws»"""
        signals = self.evaluate(**inputs)
        self.advance(signals, self.parameters.get("sample", self.constants.get("sample", 0.0)))
        return signals

    def _integrated(self, signals: dict[str, Any], duration: float) -> dict[str, float]:
        steps = 1
        if self.cls.step is not None:
            steps = max(1, math.ceil(round(duration * 1e9) / self.cls.step))
        h = duration / steps
        in_blocks = self._moved_by_matrices(signals, h, steps)
        names = [name for name, _ in self.cls.derivatives if name not in in_blocks]
        x = {name: signals[name] for name in names}
        # A derivative has the type of its state, apart from the unit.
        kinds = {name: value.type for name, value in self.cls.derivatives}
        began = self.time
        for step in range(steps):
            t = began + step * h

            def slope(
                shift: float, k: Mapping[str, float] | None, x: dict[str, float] = x, t: float = t
            ) -> dict[str, float]:
                moved = {name: fitting(kinds[name], x[name] + shift * (k[name] if k else 0.0)) for name in names}
                return self._derivatives(names, {**signals, **moved}, t + shift)

            k1 = slope(0.0, None)
            if self.cls.method == "euler":
                x = {name: fitting(kinds[name], x[name] + h * k1[name]) for name in names}
                continue
            k2 = slope(h / 2, k1)
            k3 = slope(h / 2, k2)
            k4 = slope(h, k3)
            x = {n: fitting(kinds[n], x[n] + h / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n])) for n in names}
        self.time = began
        moved = {**in_blocks, **x}
        return {name: moved[name] for name, _ in self.cls.derivatives}

    def _derivatives(self, names: Collection[str], signals: dict[str, Any], time: float) -> dict[str, float]:
        self.time = time
        slopes = {name: value for name, value in self.cls.derivatives if name in names}
        for equation in _needed(self.cls.derivative_equations, _read(slopes.values())):
            signals[equation.name] = self.value(equation.value, signals)
        return {name: self.value(value, signals) for name, value in slopes.items()}

    def _moved_by_matrices(self, signals: Mapping[str, Any], h: float, steps: int) -> dict[str, float]:
        """The states of all linear blocks after some steps of ``h`` seconds. «Linear plants»"""
        moved: dict[str, float] = {}
        for block in self.cls.linear:
            moving: dict[str, Any] = {name: Linear({name: 1.0}) for name in block.states}
            slopes = {name: value for name, value in self.cls.derivatives if name in block.states}

            def form(expression: Expression, moving: Mapping[str, Any] = moving) -> Any:
                return linear(expression, moving, lambda part: self.value(part, signals))

            for equation in _needed(self.cls.derivative_equations, _read(slopes.values())):
                moving[equation.name] = form(equation.value)
            found = {name: form(value) for name, value in slopes.items()}
            moved |= rk4(found, {name: signals[name] for name in found}, h, steps)
        return moved

    def value(self, expression: Expression, signals: Mapping[str, Any]) -> Any:
        """The value of an expression over the signals. «Expressions»"""
        return value_of(expression, self.parameters, self.variables, signals.__getitem__, self.time)


def _needed(equations: Sequence[SubmodelEquation | ExternalCall], roots: Collection[str]) -> list[Any]:
    """The equations that some signals depend on, in their order; calls of other languages always."""
    wanted = set(roots)
    found: list[SubmodelEquation | ExternalCall] = []
    for equation in reversed(equations):
        if isinstance(equation, ExternalCall):
            wanted.update(name for _, value in equation.inputs for name in signals_read(value))
        elif equation.name in wanted:
            wanted.update(signals_read(equation.value))
        else:
            continue
        found.append(equation)
    return found[::-1]


def _read(expressions: Iterable[Expression]) -> set[str]:
    return {name for expression in expressions for name in signals_read(expression)}


def _finite(x: float) -> float:
    if not math.isfinite(x):
        raise FaultError("a real value is infinite or not a number")
    return x
