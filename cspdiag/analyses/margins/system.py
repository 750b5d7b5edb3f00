"""A loop of a program as one linear system, cut at an output of a law: what the law computes for what it is taken to
have written.

Everything is followed instant by instant over one period of the law, as the language says (section "Time"): the plant
between the instants with its inputs held, samples at the ticks, outputs that change at the tick after they were
written, faster laws inside. So the result is exact for the linearized parts, whatever the rates, as long as they divide
the period.
"""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.law import Leaf, LinearLaw, linearize
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.margins.open_loop import Cut, OpenLoop
from cspdiag.analyses.margins.steps import advanced, combined
from cspdiag.analyses.margins.structure import Structure, end_name, standing_inputs
from cspdiag.base.graphs import reached
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import CoreNetwork, Environment, SubmodelClass

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]

LARGEST_NUMBER_OF_INSTANTS = 20_000
"""Grids finer than this within one period are refused."""


class Loops:
    """The laws of a program beside one environment, linearized about an operating point."""

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
        """External port by the path of its net."""
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
        """The law at a path, linearized; raises NotLinearError."""
        found = self._laws.get(path)
        if found is None:
            point = standing_inputs(self.network, path)
            found = self._laws[path] = linearize(self.classes[path], self.parameters[path], point=point)
        return found

    def _periods(self) -> dict[str, int]:
        """The period of each law in nanoseconds: that of its sampled nets, or what it was given as ``sample``."""
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
        """The nets that a law writes, and the variables that processes copy them into."""
        entry = self.classes[path]
        nets = [
            net for port in entry.ports if port.direction == "out" for net in self._nets(path, port.name, port.size)
        ]
        return [net for written in nets for net in (written, *self.copied.get(written, ()))]

    def _nets(self, path: str, port: str, size: int | None) -> list[str]:
        names = [port] if size is None else [f"{port}[{k}]" for k in range(size)]
        return [self.net_of[path, name] for name in names if (path, name) in self.net_of]

    def within(self, path: str) -> list[str]:
        """The laws on the way from a law through the plant back to it, without itself; slower ones are left open."""
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
        """Of some laws those that read what a law writes."""

        def readers(path: str) -> list[str]:
            return [law for net in self.nets_after(path) for law in usable if self.is_read_by(net, law)]

        return set(reached(readers(path), readers))

    def is_read_by(self, net: str, law: str) -> bool:
        """Whether a law reads a net, or, an output of the program, what the plant answers to it."""
        if law in self.readers.get(net, ()):
            return True
        port = self.outside.get(net)
        if port is None or self.external[port].direction != "out":
            return False
        answering = self.answering(port)
        return any(
            law in self.readers[other]
            for other, name in self.outside.items()
            if self.external[name].direction == "in" and name in answering
        )

    def answering(self, port: str) -> set[str]:
        """The inputs of the program at which the plant answers to an output, sooner or later."""
        plant = self.plant
        size = len(plant.discrete) + len(plant.continuous)
        rows = [*plant.next, *plant.rates]
        moved = {size + k for k, (name, _) in enumerate(plant.inputs) if name == port}
        while True:
            more = {k for k, row in enumerate(rows) if any(_answers(row, j) for j in moved)} - moved
            if not more:
                break
            moved |= more
        return {
            name
            for (name, _), row in zip(plant.output_names, plant.outputs, strict=True)
            if any(_answers(row, j) for j in moved)
        }

    def open(self, cut: Cut) -> OpenLoop:
        """The loop cut at an output. Raises NotLinearError where a law in it is not linear or the rates do not fit."""
        return _Follower(self, cut).open_loop()


def _answers(row: Matrix, column: int) -> bool:
    """Whether a coefficient is more than what rounding leaves of terms that cancel."""
    return bool(abs(row[column]) > 1e-9 * max(1.0, abs(row).max()))


def _numbered(name: str, index: int | None) -> str:
    return name if index is None or name.endswith("]") else f"{name}[{index}]"


def _refuse_offsets(network: CoreNetwork, plant: LinearLaw) -> None:
    """Raises NotLinearError where laws do not begin together, or discrete parts of the plant step beside its grid."""
    for port in network.external_ports:
        if port.sampling is None or not port.sampling.offset:
            continue
        if port.direction == "in":
            raise NotLinearError(
                f"the samples of `{port.name}` have an offset, which is followed of outputs", port.span
            )
        if plant.discrete:
            raise NotLinearError(
                f"`{port.name}` has an offset, which is followed only where the plant has no discrete parts", port.span
            )


class _Follower:
    """Follows every number as a combination of those at the beginning of a period and of the cut's value."""

    def __init__(self, loops: Loops, cut: Cut) -> None:
        import numpy

        self.numpy = numpy
        self.loops = loops
        self.cut = cut
        self.period = loops.periods[cut.law]
        inside = [cut.law, *loops.within(cut.law)]
        order = {path: k for k, path in enumerate(loops.classes)}
        self.laws = sorted(inside, key=lambda path: (self._rank(path), order[path]))
        self._by_data()
        self.places: dict[tuple[str, Leaf], int] = {}
        plant = loops.plant
        for leaf in (*plant.discrete, *plant.continuous):
            self.places["plant", leaf] = len(self.places)
        for leaf in plant.inputs:
            self.places["held", leaf] = len(self.places)
            self.places["latch", leaf] = len(self.places)
        for path in self.laws:
            law = loops.law(path)
            for leaf in (*law.discrete, *law.continuous):
                self.places[path, leaf] = len(self.places)
            for name, way in law.output_names:
                net = loops.net_of.get((path, name))
                for written in () if net is None else (net, *loops.copied.get(net, ())):
                    self.places.setdefault(("net", (written, way)), len(self.places))
        size = len(self.places)
        self.state: dict[tuple[str, Leaf], Any] = dict(zip(self.places, numpy.eye(size, size + 1), strict=True))
        self.test = numpy.eye(size + 1)[size]
        self.zero = numpy.zeros(size + 1)
        self.computed: Any = self.zero
        self._moves: dict[tuple[int, bool, int], Matrix] = {}

    def _rank(self, path: str) -> tuple[tuple[int, ...], int]:
        """Priority, and then the order of the ports whose samples wake the laws."""
        priority = self.loops.structure.priorities[path]
        while priority and priority[-1] == 0:
            priority = priority[:-1]
        woken = [
            k
            for k, name in enumerate(self.loops.external)
            for net, port in self.loops.outside.items()
            if port == name and path in self.loops.readers[net]
        ]
        return priority, min(woken, default=len(self.loops.external))

    def _by_data(self) -> None:
        """A law without samples of its own runs after those that write for it."""
        placed: list[str] = []
        waiting = list(self.laws)
        while waiting:
            for path in waiting:
                sources = [other for other in waiting if other != path and self._feeds(other, path)]
                if not sources or self._is_woken(path):
                    break
            else:
                path = waiting[0]
            placed.append(path)
            waiting.remove(path)
        self.laws = placed

    def _feeds(self, one: str, other: str) -> bool:
        return any(other in self.loops.readers.get(net, ()) for net in self.loops.nets_after(one))

    def _is_woken(self, path: str) -> bool:
        return self._rank(path)[1] < len(self.loops.external)

    def open_loop(self) -> OpenLoop:
        """Follow one period from tick to tick."""
        numpy = self.numpy
        environment = self.loops.environment
        grid = Sampling(environment.step)
        fine = gcd(environment.step, *(self.loops.periods[path] for path in self.laws))
        if self.period // fine > LARGEST_NUMBER_OF_INSTANTS:
            raise NotLinearError(
                f"a period has more than {LARGEST_NUMBER_OF_INSTANTS} instants of the environment", environment.span
            )
        runs = {t for path in self.laws for t in range(0, self.period, self.loops.periods[path])}
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
        a = numpy.array([self.state[place] for place in self.places])
        size = len(self.places)
        return OpenLoop(
            self.cut,
            self.period * 1e-9,
            a[:, :size],
            a[:, size:],
            self.computed[None, :size],
            float(self.computed[size]),
            (self.cut.law, *(path for path in self.laws if path != self.cut.law)),
            tuple(self.places),
        )

    def _grid(self) -> set[int]:
        """The instants at which discrete parts of the environment step; a plant without any is the same on
        every grid.
        """
        if not self.loops.plant.discrete:
            return {0}
        return set(range(0, self.period, self.loops.environment.step))

    def _latches(self) -> list[Sampling]:
        ports = (self.loops.external.get(name) for name, _ in self.loops.plant.inputs)
        return [port.sampling for port in ports if port is not None and port.sampling and not port.immediate]

    def _handed_over(self) -> set[int]:
        """The instants at which outputs with an offset change."""
        shifted = [latch for latch in self._latches() if latch.offset and self.period % latch.period == 0]
        return {t for latch in shifted for t in range(latch.offset, self.period, latch.period)}

    def _is_idle(self, instant: int) -> bool:
        """Whether nothing but the plant goes on at an instant."""
        laws = (Sampling(self.loops.periods[path]) for path in self.laws)
        return not any(sampling.is_tick(instant) for sampling in (*self._latches(), *laws))

    def _tick(self, instant: int) -> None:
        plant = self.loops.plant
        row = [self.state["plant", leaf] for leaf in (*plant.discrete, *plant.continuous)]
        row += [self.state["held", leaf] for leaf in plant.inputs]
        sampled = {
            leaf: combined(weights, row, self.zero)
            for leaf, weights in zip(plant.output_names, plant.outputs, strict=True)
        }
        for leaf in plant.inputs:
            port = self.loops.external.get(leaf[0])
            if port is not None and port.sampling and port.sampling.is_tick(instant) and not port.immediate:
                self.state["held", leaf] = self.state["latch", leaf]
        for path in self.laws:
            if Sampling(self.loops.periods[path]).is_tick(instant):
                self._run(path, sampled)

    def _run(self, path: str, sampled: dict[Leaf, Any]) -> None:
        law = self.loops.law(path)
        states = (*law.discrete, *law.continuous)
        row = [self.state[path, leaf] for leaf in states]
        row += [self._read(path, leaf, sampled) for leaf in law.inputs]
        outputs = [combined(weights, row, self.zero) for weights in law.outputs]
        following = advanced(law, row, self.loops.periods[path] * 1e-9, self.zero)
        for leaf, value in zip(states, following, strict=True):
            self.state[path, leaf] = value
        for leaf, value in zip(law.output_names, outputs, strict=True):
            if (path, leaf) == (self.cut.law, self.cut.output):
                self.computed, value = value, self.test
            self._write(path, leaf, value)

    def _read(self, path: str, leaf: Leaf, sampled: dict[Leaf, Any]) -> Any:
        net = self.loops.net_of.get((path, leaf[0]))
        if net is None:
            return self.zero
        port = self.loops.outside.get(net)
        if port is not None:
            return sampled.get((port, leaf[1]), self.zero)
        return self.state.get(("net", (net, leaf[1])), self.zero)

    def _write(self, path: str, leaf: Leaf, value: Any) -> None:
        name, way = leaf
        net = self.loops.net_of.get((path, name))
        if net is None:
            return
        for written in (net, *self.loops.copied.get(net, ())):
            self.state["net", (written, way)] = value
        port = self.loops.outside.get(net)
        if port is None:
            return
        declared = self.loops.external[port]
        kind = "latch" if declared.sampling is not None and not declared.immediate else "held"
        if (kind, (port, way)) in self.state:
            self.state[kind, (port, way)] = value

    def _advance(self, duration: int, steps: bool, times: int) -> None:
        """The plant goes on with its inputs held, a stretch of time after another of the same length; its discrete
        parts step if they do so at the beginnings of these.
        """
        numpy = self.numpy
        plant = self.loops.plant
        places = [("plant", leaf) for leaf in (*plant.discrete, *plant.continuous)]
        places += [("held", leaf) for leaf in plant.inputs]
        if not places:
            return
        key = duration, steps, times
        if key not in self._moves:
            unit = list(numpy.eye(len(places)))
            moved = advanced(plant, unit, duration * 1e-9, numpy.zeros(len(places)))
            kept = 0 if steps else len(plant.discrete)
            once = numpy.array([*unit[:kept], *moved[kept:], *unit[len(moved) :]])
            self._moves[key] = numpy.linalg.matrix_power(once, times)
        following = self._moves[key] @ numpy.array([self.state[place] for place in places])
        self.state.update(zip(places, following, strict=True))
