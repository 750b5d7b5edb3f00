"""An FMU as a part of an environment: a class like that of a body written in Python."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from cspdiag.base.record import EMPTY
from cspdiag.fmu.description import FmuError, FmuVariable, read_description
from cspdiag.fmu.library import Library, Value

MOST_EVENTS = 1000
"""In one step, after which the FMU is considered not to get any further."""
BISECTIONS = 48
"""Halvings of a step in which an event is located."""


class Fmu:
    """An FMU with the values of its parameters; ``outputs`` are the ports that it computes, in order.

    ``interface`` is ``CoSimulation`` or ``ModelExchange``; empty for the first of these that it has. A step goes from
    the instant of the last call to the present one, with the inputs of the present call held, as everywhere in an
    environment; the outputs are those at its end. ``step``, in nanoseconds, is the longest one of the integration.
    """

    def __init__(
        self,
        path: str,
        interface: str,
        outputs: Sequence[str],
        parameters: Mapping[str, Value] = EMPTY,
        *,
        step: int | None = None,
        method: str = "rk4",
    ) -> None:
        self._path = path
        self._model_exchange = (interface or default_interface(path)) == "ModelExchange"
        self._outputs = [self._variable(name) for name in outputs]
        self._parameters = [(self._variable(name), value) for name, value in parameters.items()]
        self._inputs: list[FmuVariable] | None = None
        self._library: Library | None = None
        self._time = 0.0
        self._given: list[Value] = []
        self._next_event: float | None = None
        self._longest = None if step is None else step / 1e9
        self._move = _euler if method == "euler" else _runge_kutta
        # An FMU that cannot be loaded is reported before the run.
        self._library = Library(path, model_exchange=self._model_exchange)
        self._is_begun = False

    def _variable(self, name: str) -> FmuVariable:
        found = read_description(self._path).named(name)
        if found is None:
            raise FmuError(f"{self._path} has no variable {name}", "name a variable of the FMU")
        return found

    def reset(self) -> None:
        """Begins again at the next call."""
        if self._is_begun:
            assert self._library is not None
            self._library.free()
            self._library = Library(self._path, model_exchange=self._model_exchange)
            self._is_begun = False

    def calculate(self, time: float = 0.0, **inputs: Value) -> Value | tuple[Value, ...]:
        """The outputs at ``time``, in seconds."""
        library = self._library
        assert library is not None
        if self._inputs is None:
            self._inputs = [self._variable(name) for name in inputs]
        given = list(zip(self._inputs, inputs.values(), strict=True))
        if not self._is_begun:
            library.initialize(time, [*self._parameters, *self._written(given)])
            if self._model_exchange:
                self._next_event = self._after_event(library, time)
            self._is_begun = True
        elif self._model_exchange:
            self._give(library, given)
            self._integrate(library, time)
        else:
            library.give(self._time, self._written(given))
            library.step(self._time, time - self._time)
        self._time = time
        self._given = list(inputs.values())
        values = library.take(time, self._outputs)
        return values[0] if len(values) == 1 else tuple(values)

    def _written(self, given: Sequence[tuple[FmuVariable, Value]]) -> list[tuple[FmuVariable, Value]]:
        """Inputs without enumerations that still are 0, which is none of their numbers: nobody has written them, and
        the FMU has a value for that.
        """
        before = self._given or [0] * len(given)
        return [item for item, last in zip(given, before, strict=True) if item[1] or last or not item[0].lacks_zero]

    # ---- Model exchange: the classical Runge-Kutta method, with events located by bisection

    def _give(self, library: Library, given: Sequence[tuple[FmuVariable, Value]]) -> None:
        """Sets inputs; discrete ones, if they have changed, in an event."""
        changed = [item for item, before in zip(given, self._given, strict=True) if item[1] != before]
        events = [item for item in changed if item[0].variability != "continuous"]
        if events:
            library.enter_event_mode(self._time)
            library.give(self._time, changed)
            self._next_event = self._after_event(library, self._time)
        else:
            library.give(self._time, changed)

    def _after_event(self, library: Library, time: float) -> float | None:
        next_event = library.update(time)
        library.enter_continuous_time_mode(time)
        return next_event

    def _integrate(self, library: Library, end: float) -> None:
        time, events = self._time, 0
        grid = self._grid(time, end)
        while time < end:
            if events > MOST_EVENTS:
                raise FmuError(
                    f"{self._path} has more than {MOST_EVENTS} events in the step to {end:.9g} s",
                    "it does not get any further",
                )
            target = grid[0]
            if time >= target:
                grid.pop(0)
                continue
            if self._next_event is not None and self._next_event < target:
                target = self._next_event
            is_time_event = self._next_event is not None and target == self._next_event
            states, before = library.states(), library.signs(time)
            after = self._move(library, time, states, target - time)
            library.go_to(target, after)
            located = library.signs(target) != before
            if located:
                target, after = self._located(library, time, states, target - time, before)
                is_time_event = False
            time = target
            steps_event = library.step_completed(time)
            if located or is_time_event or steps_event:
                events += 1
                library.enter_event_mode(time)
                self._next_event = self._after_event(library, time)

    def _grid(self, begin: float, end: float) -> list[float]:
        """The ends of equal sub-steps, the least number of them that are not longer than the step."""
        if self._longest is None:
            return [end]
        count = max(1, math.ceil((end - begin) / self._longest - 1e-9))
        h = (end - begin) / count
        return [*(begin + number * h for number in range(1, count)), end]

    def _located(
        self, library: Library, time: float, states: Sequence[float], length: float, before: Sequence[bool]
    ) -> tuple[float, list[float]]:
        """The instant just after the first event of a step, and the states there."""
        earlier, later = 0.0, length
        for _ in range(BISECTIONS):
            middle = earlier + (later - earlier) / 2.0
            if not earlier < middle < later:
                break
            library.go_to(time + middle, self._move(library, time, states, middle))
            if library.signs(time + middle) == before:
                earlier = middle
            else:
                later = middle
        after = self._move(library, time, states, later)
        library.go_to(time + later, after)
        library.signs(time + later)
        return time + later, after


def _euler(library: Library, time: float, states: Sequence[float], h: float) -> list[float]:
    """The states after a step of Euler's method."""
    slopes = library.slopes(time, states)
    return [x + h * k for x, k in zip(states, slopes, strict=True)]


def _runge_kutta(library: Library, time: float, states: Sequence[float], h: float) -> list[float]:
    """The states after a step of the classical Runge-Kutta method, in the order of operations of environments."""
    half, sixth = h / 2.0, h / 6.0
    k1 = library.slopes(time, states)
    k2 = library.slopes(time + half, [x + half * k for x, k in zip(states, k1, strict=True)])
    k3 = library.slopes(time + half, [x + half * k for x, k in zip(states, k2, strict=True)])
    k4 = library.slopes(time + h, [x + h * k for x, k in zip(states, k3, strict=True)])
    return [x + sixth * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in zip(states, k1, k2, k3, k4, strict=True)]


def default_interface(path: str) -> str:
    """Co-simulation, if an FMU is made for that, and otherwise model exchange.

    Raises FmuError for one that is made for neither.
    """
    description = read_description(path)
    if description.co_simulation is not None:
        return "CoSimulation"
    if description.model_exchange is not None:
        return "ModelExchange"
    raise FmuError(f"{path} is made neither for co-simulation nor for model exchange", "export it for co-simulation")
