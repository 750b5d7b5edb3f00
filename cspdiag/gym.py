"""An environment of a program as a Gymnasium environment: a policy takes the place of the program.

``PlantEnv`` drives the plant that ``cspdiag run`` simulates, by the same generated code and so with the same bits:
actions are the outputs of the program, observations its inputs. Interface: https://gymnasium.farama.org/api/env.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from cspdiag import pipeline
from cspdiag.api import LoadedProgram, load
from cspdiag.arguments import Setting, shown, time_limit
from cspdiag.base.errors import ArgumentError, CspdiagError, file_errors, missing_package
from cspdiag.base.sources import read_source
from cspdiag.model.constants.durations import duration
from cspdiag.model.types import BoolType, IntType, RealType
from cspdiag.runtime import Fault
from cspdiag.runtime.outside.drivers import Signal
from cspdiag.simulate.run.execute import NoEnvironmentError, chosen_environment
from cspdiag.simulate.run.package import LoadedPackage

try:
    import gymnasium
    import numpy
except ImportError as problem:
    raise missing_package(str(problem.name), "gym") from None

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from cspdiag.network.ir.network import CoreNetwork, Direction, Environment, ExternalPort

    Vector: TypeAlias = NDArray[numpy.float64]

Reward: TypeAlias = "Callable[[Vector, Vector], float]"
Terminated: TypeAlias = "Callable[[Vector], bool]"
Limits: TypeAlias = "Mapping[str, float | tuple[float, float]]"

_KEPT_PLANTS = 64
"""Plants with different settings that are kept, because each has to be compiled."""


class PlantError(CspdiagError, ValueError):
    """The environment cannot be driven by a policy: it has devices, or ports whose values are not numbers."""


class _Plant:
    """The generated environment of one program with one collection of settings."""

    def __init__(self, network: CoreNetwork, environment: str | None) -> None:
        chosen = chosen_environment(network, environment)
        if chosen is None or chosen.system is None:
            raise NoEnvironmentError(f"`{network.top}` has no environment with a plant that a policy could drive")
        if chosen.drivers:
            raise PlantError(
                f"the environment `{chosen.name}` has the device `{chosen.drivers[0].name}`, which follows the clock: "
                "choose an environment that consists of submodels"
            )
        self.name = chosen.name
        self.step = chosen.step
        self.outputs = _numbers(network, "in")
        self.inputs = _numbers(network, "out")
        self.period = _common_period(network, chosen)
        self._samplings = {port.sampling for port in network.external_ports if port.sampling is not None}
        self._ticks_on_grid = all(
            sampling.period % self.step == sampling.offset % self.step == 0 for sampling in self._samplings
        )
        with file_errors():
            files = pipeline.generate(network, read_source, level=1)
        self._package = LoadedPackage(network.name, files)
        self.system: Any = self._package.module("environments").ENVIRONMENTS[chosen.name]()
        drivers = self.system.drivers
        self.output_signals: list[Signal[Any]] = [drivers[port.key] for port in self.outputs]
        self.input_signals: list[Signal[Any]] = [drivers[port.key] for port in self.inputs]

    def instants(self, begin: int, end: int) -> Sequence[int]:
        """When the environment is evaluated after ``begin`` and up to ``end``: on its grid, and at each tick."""
        if self._ticks_on_grid and begin % self.step == end % self.step == 0:
            return range(begin + self.step, end + 1, self.step)
        found = set(range(begin - begin % self.step + self.step, end + 1, self.step))
        for sampling in self._samplings:
            found.update(range(sampling.next_tick(begin), end + 1, sampling.period))
        return sorted({*found, end})

    def close(self) -> None:
        self._package.close()


class PlantEnv(gymnasium.Env[Any, Any]):
    """The environment ``environment`` of ``program`` (the first one by default), driven by actions.

    An action has the value of each output of the program, an observation that of each input, in the order of the
    text; both are arrays of float64. ``action_names`` and ``observation_names`` have the names, in which elements of
    arrays of ports are ports (``lamp[1]``). An action holds for ``period``, by default the shortest sample period of
    the program.

    ``limits`` has the least and the greatest value of ports, or the greatest magnitude. ``reward(observation, action)``
    is computed after each step; ``terminated(observation)`` ends an episode, and so does a fault in the plant, of which
    ``info["fault"]`` has the text. ``until`` truncates it. Periods and times are texts such as ``"2 ms"``, or seconds.

    ``reset(options={"set": {"pan.inertia": 2e-3}})`` begins an episode with other constants and parameters, besides
    those of ``set``. Each new collection of settings takes the time of a compilation; the last 64 are kept.

    Raises what ``cspdiag.load`` and ``LoadedProgram.build`` raise, NoEnvironmentError, ``PlantError`` for an
    environment with devices or with ports that are not numbers, and ArgumentError.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(
        self,
        program: str | os.PathLike[str] | LoadedProgram,
        environment: str | None = None,
        *,
        reward: Reward | None = None,
        terminated: Terminated | None = None,
        limits: Limits | None = None,
        period: str | float | None = None,
        until: str | float = "10 s",
        set: Mapping[str, Setting] | None = None,
    ) -> None:
        self._program = program if isinstance(program, LoadedProgram) else load(program)
        self._environment = environment
        self._settings = dict(set or {})
        self._reward = reward
        self._terminated = terminated
        self._plants: dict[tuple[tuple[str, Setting], ...], _Plant] = {}
        self._plant = plant = self._plant_with({})
        self._period = plant.period if period is None else _period(period)
        self._until = time_limit(until)
        self.action_names = tuple(port.key for port in plant.inputs)
        self.observation_names = tuple(port.key for port in plant.outputs)
        known = {*self.action_names, *self.observation_names}
        for name in limits or {}:
            if name not in known:
                raise ArgumentError(f"limits: there is no port {shown(name)}; there are: {', '.join(sorted(known))}")
        self.action_space = _space(plant.inputs, limits or {})
        self.observation_space = _space(plant.outputs, limits or {})
        self._convert = [_converter(port) for port in plant.inputs]
        self._now = 0
        self._observation: Vector = numpy.zeros(len(plant.outputs))
        self._is_running = False

    @property
    def now(self) -> float:
        """The present instant in seconds from the beginning of the episode."""
        return self._now / 1_000_000_000

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        """Begin an episode at time 0; see the class."""
        super().reset(seed=seed)
        unknown = (options or {}).keys() - {"set"}
        if unknown:
            raise ArgumentError(f"options: there is no option {shown(min(unknown))}, only 'set'")
        self._plant = self._plant_with((options or {}).get("set") or {})
        for signal, port in zip(self._plant.input_signals, self._plant.inputs, strict=True):
            signal.value = _converter(port)(0.0)
        self._now = 0
        self._is_running = True
        self._plant.system.start()
        return self._observed(), {}

    def step(self, action: Any) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Hold ``action`` for one period. Raises ArgumentError for an action of another shape or that is not finite,
        and gymnasium's ResetNeeded outside an episode.
        """
        if not self._is_running:
            raise gymnasium.error.ResetNeeded("call reset() before step(): the episode has ended, or not begun")
        plant = self._plant
        taken = self._taken(action)
        for signal, convert, value in zip(plant.input_signals, self._convert, taken.tolist(), strict=True):
            signal.value = convert(value)
        end = self._now + self._period
        info: dict[str, Any] = {}
        has_ended = False
        try:
            for instant in plant.instants(self._now, end):
                plant.system.advance(instant)
            self._observed()
        except Fault as fault:
            info["fault"] = str(fault)
            has_ended = True
        self._now = end
        observation = self._observation
        has_ended = has_ended or (self._terminated is not None and bool(self._terminated(observation)))
        is_truncated = end >= self._until
        self._is_running = not (has_ended or is_truncated)
        reward = 0.0 if self._reward is None else float(self._reward(observation, taken))
        return observation, reward, has_ended, is_truncated, info

    def close(self) -> None:
        """Forget the compiled plants."""
        while self._plants:
            self._plants.popitem()[1].close()
        self._is_running = False

    def _taken(self, action: Any) -> Vector:
        try:
            taken: Vector = numpy.asarray(action, dtype=numpy.float64)
        except (TypeError, ValueError):
            raise ArgumentError(f"an action is an array of numbers, not {shown(action)}") from None
        if taken.shape != self.action_space.shape:
            raise ArgumentError(
                f"an action has the shape {self.action_space.shape} ({', '.join(self.action_names)}), not {taken.shape}"
            )
        if not numpy.isfinite(taken).all():
            raise ArgumentError(f"an action is finite, not {taken}")
        return taken

    def _observed(self) -> Vector:
        values = [signal.value for signal in self._plant.output_signals]
        self._observation = numpy.array(values, dtype=numpy.float64)
        return self._observation

    def _plant_with(self, settings: Mapping[str, Setting]) -> _Plant:
        every = {**self._settings, **settings}
        key = tuple(sorted(every.items()))
        plant = self._plants.pop(key, None)
        if plant is None:
            plant = _Plant(self._program.build(environment=self._environment, set=every), self._environment)
        self._plants[key] = plant
        if len(self._plants) > _KEPT_PLANTS:
            self._plants.pop(next(iter(self._plants))).close()
        return plant


def _numbers(network: CoreNetwork, direction: Direction) -> list[ExternalPort]:
    """The ports of a direction. Raises ``PlantError`` for one whose values are not numbers."""
    ports = [port for port in network.external_ports if port.direction == direction]
    for port in ports:
        if not isinstance(port.type, RealType | IntType | BoolType):
            raise PlantError(
                f"the port `{network.top}.{port.key}` has values of the type {port.type}, which are not numbers: "
                "a policy computes with numbers and bool only"
            )
    return ports


def _common_period(network: CoreNetwork, environment: Environment) -> int:
    """The shortest sample period of the program in nanoseconds; the grid of the environment if it has none."""
    periods = [port.sampling.period for port in network.external_ports if port.sampling is not None]
    return min(periods, default=environment.step)


def _period(text: str | float) -> int:
    period = time_limit(text)
    if period <= 0:
        raise ArgumentError(f"period: an action holds for a positive time, not {duration(period)}")
    return period


def _converter(port: ExternalPort) -> Callable[[float], Any]:
    if isinstance(port.type, BoolType):
        return lambda value: value >= 0.5
    if isinstance(port.type, RealType):
        return float
    assert isinstance(port.type, IntType)
    low, high = _range(port.type)
    return lambda value: min(max(round(value), low), high)


def _range(type_: IntType) -> tuple[int, int]:
    """The least and the greatest value."""
    return (-(1 << type_.bits - 1), (1 << type_.bits - 1) - 1) if type_.signed else (0, (1 << type_.bits) - 1)


def _space(ports: list[ExternalPort], limits: Limits) -> gymnasium.spaces.Box:
    bounds = list(_bounds(ports, limits))
    return gymnasium.spaces.Box(
        numpy.array([low for low, _ in bounds], dtype=numpy.float64),
        numpy.array([high for _, high in bounds], dtype=numpy.float64),
        dtype=numpy.float64,
    )


def _bounds(ports: list[ExternalPort], limits: Limits) -> Iterator[tuple[float, float]]:
    """The least and the greatest value of each port: as given, or those of its type."""
    for port in ports:
        given = limits.get(port.key)
        if given is not None:
            low, high = given if isinstance(given, tuple) else (-given, given)
            if not low <= high:
                raise ArgumentError(f"limits: {port.key} lies between {low} and {high}, which leaves no value")
            yield float(low), float(high)
        elif isinstance(port.type, BoolType):
            yield 0.0, 1.0
        elif isinstance(port.type, IntType):
            low, high = _range(port.type)
            yield float(low), float(high)
        else:
            yield -numpy.inf, numpy.inf
