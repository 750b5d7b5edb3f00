"""A loop of a program as one linear system.

The loop is cut at an output of a law; the system gives what the law computes for what it is assumed to have written.
One period of the law is followed instant by instant, as the language defines it (section "Time"): the plant between the
instants with its inputs held, samples at the ticks, outputs that change at the tick after they were written, and faster
laws in between. So the result is exact for the linearized parts at all rates that divide the period.
"""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.law import Leaf, LinearLaw, linearize
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.margins.open_loop import Cut, OpenLoop
from cspdiag.analyses.margins.steps import advanced, combined
from cspdiag.analyses.margins.structure import Structure, end_name, initial_inputs
from cspdiag.base.graphs import reached
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import CoreNetwork, Environment, SubmodelClass

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]

LARGEST_NUMBER_OF_INSTANTS = 20_000
"""A finer grid within one period is refused."""


class LinearizedProgram:
    """The laws of a program and one environment, linearized about an operating point."""

    def __init__(self, network: CoreNetwork, environment: Environment, point: dict[str, float]) -> None:
        if environment.system is None:
            raise NotLinearError(
                f"the environment `{environment.name}` has no model of the plant, only drivers", environment.span
            )
        self.network = network
        self.environment = environment
        self.structure = Structure(network)
        self.plant = linearize(environment.system, {}, point=point)
        _refuse_offsets(network, self.plant)
        self.classes = {
            instance.path: entry
            for instance in network.instances
            if isinstance(entry := network.class_named(instance.class_name), SubmodelClass)
        }
        self.parameters = {instance.path: dict(instance.arguments) for instance in network.instances}
        self.external = {_numbered(port.name, port.index): port for port in network.external_ports}
        self.net_of: dict[tuple[str, str], str] = {}
        self.outside: dict[str, str] = {}
        """The external port of a net, by the path of the net."""
        self.readers: dict[str, list[str]] = {}
        for net in network.nets:
            for path, port in (*net.writers, *net.readers):
                self.net_of[path, port] = net.path
            self.readers[net.path] = [path for path, _ in net.readers]
            if net.external is not None:
                self.outside[net.path] = net.path.partition(".")[2]
        self.copied: dict[str, list[str]] = {}
        for copy in self.structure.copies:
            source = self.net_of.get((copy.process, end_name(copy.source)), f"{copy.process}.{end_name(copy.source)}")
            self.copied.setdefault(source, []).append(f"{copy.process}.{copy.variable}")
        self.periods = self._periods()
        self._laws: dict[str, LinearLaw] = {}

    def law(self, path: str) -> LinearLaw:
        """The law at a path, linearized. Raises NotLinearError."""
        found = self._laws.get(path)
        if found is None:
            point = initial_inputs(self.network, path)
            found = self._laws[path] = linearize(self.classes[path], self.parameters[path], point=point)
        return found

    def _periods(self) -> dict[str, int]:
        """The period of each law in nanoseconds: that of its sampled nets, or its parameter ``sample``."""
        found: dict[str, int] = {}
        for net in self.network.nets:
            if net.sampling is not None:
                for path, _ in (*net.writers, *net.readers):
                    if path in self.classes:
                        found[path] = min(net.sampling.period, found.get(path, net.sampling.period))
        for path in self.classes:
            sample = self.parameters[path].get("sample")
            if path not in found and isinstance(sample, float):
                found[path] = round(sample * 1e9)
        return found

    def nets_after(self, path: str) -> list[str]:
        """The nets that a law writes, and the variables into which processes copy them."""
        entry = self.classes[path]
        nets = [
            net for port in entry.ports if port.direction == "out" for net in self._nets(path, port.name, port.size)
        ]
        return [net for written in nets for net in (written, *self.copied.get(written, ()))]

    def _nets(self, path: str, port: str, size: int | None) -> list[str]:
        names = [port] if size is None else [f"{port}[{k}]" for k in range(size)]
        return [self.net_of[path, name] for name in names if (path, name) in self.net_of]

    def laws_between(self, path: str) -> list[str]:
        """The other laws on a path from a law through the plant back to it; slower ones are left open."""
        period = self.periods[path]
        usable = [
            other
            for other in self.classes
            if other != path
            and other in self.periods
            and period % self.periods[other] == 0
            and self.structure.are_active_together(path, other)
        ]
        forward = self.reachable(path, usable)
        return [other for other in usable if other in forward and path in self.reachable(other, [*usable, path])]

    def reachable(self, path: str, usable: list[str]) -> set[str]:
        """Those of some laws that read what a law writes, directly or through others."""

        def readers(path: str) -> list[str]:
            return [law for net in self.nets_after(path) for law in usable if self.is_read_by(net, law)]

        return set(reached(readers(path), readers))

    def is_read_by(self, net: str, law: str) -> bool:
        """Whether a law reads a net or, for an output of the program, an input at which the plant responds to it."""
        if law in self.readers.get(net, ()):
            return True
        port = self.outside.get(net)
        if port is None or self.external[port].direction != "out":
            return False
        responding_inputs = self.responding_inputs(port)
        return any(
            law in self.readers[other]
            for other, name in self.outside.items()
            if self.external[name].direction == "in" and name in responding_inputs
        )

    def responding_inputs(self, port: str) -> set[str]:
        """The inputs of the program at which the plant responds to an output, now or later."""
        plant = self.plant
        size = len(plant.discrete) + len(plant.continuous)
        rows = [*plant.next, *plant.rates]
        moved = {size + k for k, (name, _) in enumerate(plant.inputs) if name == port}
        while True:
            more = {k for k, row in enumerate(rows) if any(_has_effect(row, j) for j in moved)} - moved
            if not more:
                break
            moved |= more
        return {
            name
            for (name, _), row in zip(plant.output_names, plant.outputs, strict=True)
            if any(_has_effect(row, j) for j in moved)
        }

    def open(self, cut: Cut) -> OpenLoop:
        """The loop, cut at an output. Raises NotLinearError if a law in it is not linear or the rates do not fit."""
        return _PeriodSimulation(self, cut).open_loop()


def _has_effect(row: Matrix, column: int) -> bool:
    """Whether a coefficient is larger than the rounding error of terms that cancel."""
    return bool(abs(row[column]) > 1e-9 * max(1.0, abs(row).max()))


def _numbered(name: str, index: int | None) -> str:
    return name if index is None or name.endswith("]") else f"{name}[{index}]"


def _refuse_offsets(network: CoreNetwork, plant: LinearLaw) -> None:
    """Raises NotLinearError if laws do not begin together, or if discrete parts of the plant step off its grid."""
    for port in network.external_ports:
        if port.sampling is None or not port.sampling.offset:
            continue
        if port.direction == "in":
            raise NotLinearError(
                f"the samples of `{port.name}` have an offset, which margins follow for outputs only", port.span
            )
        if plant.discrete:
            raise NotLinearError(
                f"`{port.name}` has an offset, which margins follow only if the plant has no discrete parts", port.span
            )


class _PeriodSimulation:
    """Follows one period; every number is a row of coefficients over the states at its beginning and the value at the
    cut.
    """

    def __init__(self, program: LinearizedProgram, cut: Cut) -> None:
        import numpy

        self.numpy = numpy
        self.program = program
        self.cut = cut
        self.period = program.periods[cut.law]
        inside = [cut.law, *program.laws_between(cut.law)]
        order = {path: k for k, path in enumerate(program.classes)}
        self.laws = sorted(inside, key=lambda path: (self._rank(path), order[path]))
        self._order_by_data()
        self.index_of: dict[tuple[str, Leaf], int] = {}
        plant = program.plant
        for leaf in (*plant.discrete, *plant.continuous):
            self.index_of["plant", leaf] = len(self.index_of)
        for leaf in plant.inputs:
            self.index_of["held", leaf] = len(self.index_of)
            self.index_of["latch", leaf] = len(self.index_of)
        for path in self.laws:
            law = program.law(path)
            for leaf in (*law.discrete, *law.continuous):
                self.index_of[path, leaf] = len(self.index_of)
            for name, indexes in law.output_names:
                net = program.net_of.get((path, name))
                for written in () if net is None else (net, *program.copied.get(net, ())):
                    self.index_of.setdefault(("net", (written, indexes)), len(self.index_of))
        size = len(self.index_of)
        self.state: dict[tuple[str, Leaf], Any] = dict(zip(self.index_of, numpy.eye(size, size + 1), strict=True))
        self.test = numpy.eye(size + 1)[size]
        self.zero = numpy.zeros(size + 1)
        self.computed: Any = self.zero
        self._moves: dict[tuple[int, bool, int], Matrix] = {}

    def _rank(self, path: str) -> tuple[tuple[int, ...], int]:
        """The priority of a law, and then the position of the first port whose samples start it."""
        priority = self.program.structure.priorities[path]
        while priority and priority[-1] == 0:
            priority = priority[:-1]
        starting = [
            k
            for k, name in enumerate(self.program.external)
            for net, port in self.program.outside.items()
            if port == name and path in self.program.readers[net]
        ]
        return priority, min(starting, default=len(self.program.external))

    def _order_by_data(self) -> None:
        """Order the laws: one without samples of its own runs after those that write for it."""
        placed: list[str] = []
        waiting = list(self.laws)
        while waiting:
            for path in waiting:
                sources = [other for other in waiting if other != path and self._feeds(other, path)]
                if not sources or self._is_started_by_sample(path):
                    break
            else:
                path = waiting[0]
            placed.append(path)
            waiting.remove(path)
        self.laws = placed

    def _feeds(self, one: str, other: str) -> bool:
        return any(other in self.program.readers.get(net, ()) for net in self.program.nets_after(one))

    def _is_started_by_sample(self, path: str) -> bool:
        return self._rank(path)[1] < len(self.program.external)

    def open_loop(self) -> OpenLoop:
        """Follow one period from tick to tick."""
        numpy = self.numpy
        environment = self.program.environment
        grid = Sampling(environment.step)
        fine = gcd(environment.step, *(self.program.periods[path] for path in self.laws))
        if self.period // fine > LARGEST_NUMBER_OF_INSTANTS:
            raise NotLinearError(
                f"a period has more than {LARGEST_NUMBER_OF_INSTANTS} instants of the environment", environment.span
            )
        runs = {t for path in self.laws for t in range(0, self.period, self.program.periods[path])}
        ticks = sorted(runs | self._handed_over() | self._grid())
        spans = [
            (following - instant, grid.is_tick(instant))
            for instant, following in zip(ticks, [*ticks[1:], self.period], strict=True)
        ]
        position = 0
        while position < len(ticks):
            self._tick(ticks[position])
            following = position + 1
            while following < len(ticks) and spans[following] == spans[position] and self._is_idle(ticks[following]):
                following += 1
            self._advance(*spans[position], times=following - position)
            position = following
        a = numpy.array([self.state[place] for place in self.index_of])
        size = len(self.index_of)
        return OpenLoop(
            self.cut,
            self.period * 1e-9,
            a[:, :size],
            a[:, size:],
            self.computed[None, :size],
            float(self.computed[size]),
            (self.cut.law, *(path for path in self.laws if path != self.cut.law)),
            tuple(self.index_of),
        )

    def _grid(self) -> set[int]:
        """The instants at which discrete parts of the environment step; a plant without any needs no grid."""
        if not self.program.plant.discrete:
            return {0}
        return set(range(0, self.period, self.program.environment.step))

    def _latches(self) -> list[Sampling]:
        ports = (self.program.external.get(name) for name, _ in self.program.plant.inputs)
        return [port.sampling for port in ports if port is not None and port.sampling and not port.immediate]

    def _handed_over(self) -> set[int]:
        """The instants at which outputs with an offset change."""
        shifted = [latch for latch in self._latches() if latch.offset and self.period % latch.period == 0]
        return {t for latch in shifted for t in range(latch.offset, self.period, latch.period)}

    def _is_idle(self, instant: int) -> bool:
        """Whether only the plant changes at an instant."""
        laws = (Sampling(self.program.periods[path]) for path in self.laws)
        return not any(sampling.is_tick(instant) for sampling in (*self._latches(), *laws))

    def _tick(self, instant: int) -> None:
        plant = self.program.plant
        row = [self.state["plant", leaf] for leaf in (*plant.discrete, *plant.continuous)]
        row += [self.state["held", leaf] for leaf in plant.inputs]
        sampled = {
            leaf: combined(weights, row, self.zero)
            for leaf, weights in zip(plant.output_names, plant.outputs, strict=True)
        }
        for leaf in plant.inputs:
            port = self.program.external.get(leaf[0])
            if port is not None and port.sampling and port.sampling.is_tick(instant) and not port.immediate:
                self.state["held", leaf] = self.state["latch", leaf]
        for path in self.laws:
            if Sampling(self.program.periods[path]).is_tick(instant):
                self._run(path, sampled)

    def _run(self, path: str, sampled: dict[Leaf, Any]) -> None:
        law = self.program.law(path)
        states = (*law.discrete, *law.continuous)
        row = [self.state[path, leaf] for leaf in states]
        row += [self._read(path, leaf, sampled) for leaf in law.inputs]
        outputs = [combined(weights, row, self.zero) for weights in law.outputs]
        following = advanced(law, row, self.program.periods[path] * 1e-9, self.zero)
        for leaf, value in zip(states, following, strict=True):
            self.state[path, leaf] = value
        for leaf, value in zip(law.output_names, outputs, strict=True):
            if (path, leaf) == (self.cut.law, self.cut.output):
                self.computed, value = value, self.test
            self._write(path, leaf, value)

    def _read(self, path: str, leaf: Leaf, sampled: dict[Leaf, Any]) -> Any:
        net = self.program.net_of.get((path, leaf[0]))
        if net is None:
            return self.zero
        port = self.program.outside.get(net)
        if port is not None:
            return sampled.get((port, leaf[1]), self.zero)
        return self.state.get(("net", (net, leaf[1])), self.zero)

    def _write(self, path: str, leaf: Leaf, value: Any) -> None:
        name, indexes = leaf
        net = self.program.net_of.get((path, name))
        if net is None:
            return
        for written in (net, *self.program.copied.get(net, ())):
            self.state["net", (written, indexes)] = value
        port = self.program.outside.get(net)
        if port is None:
            return
        declared = self.program.external[port]
        kind = "latch" if declared.sampling is not None and not declared.immediate else "held"
        if (kind, (port, indexes)) in self.state:
            self.state[kind, (port, indexes)] = value

    def _advance(self, duration: int, steps: bool, times: int) -> None:
        """Advance the plant with its inputs held by ``times`` intervals of the same length; with ``steps`` its discrete
        parts step at the beginning of each.
        """
        numpy = self.numpy
        plant = self.program.plant
        keys = [("plant", leaf) for leaf in (*plant.discrete, *plant.continuous)]
        keys += [("held", leaf) for leaf in plant.inputs]
        if not keys:
            return
        key = duration, steps, times
        if key not in self._moves:
            unit = list(numpy.eye(len(keys)))
            moved = advanced(plant, unit, duration * 1e-9, numpy.zeros(len(keys)))
            kept = 0 if steps else len(plant.discrete)
            once = numpy.array([*unit[:kept], *moved[kept:], *unit[len(moved) :]])
            self._moves[key] = numpy.linalg.matrix_power(once, times)
        following = self._moves[key] @ numpy.array([self.state[one] for one in keys])
        self.state.update(zip(keys, following, strict=True))
