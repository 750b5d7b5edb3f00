"""A loop of a program as one linear system.

The loop is cut at an output of a law; the system gives what the law computes for what it is assumed to have written.
One period of the law is followed instant by instant, as the language defines it (section "Time"): the plant between the
instants with its inputs held, samples at the ticks, outputs that change at the tick after they were written, and faster
laws in between. So the result is exact for the linearized parts at all rates that divide the period.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd
from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.composition.feedback import coefficients, rank
from cspdiag.analyses.margins.composition.regular import Turn
from cspdiag.analyses.margins.composition.turns import Statement
from cspdiag.analyses.margins.law import Leaf, leaves
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.margins.open_loop import Cut, OpenLoop
from cspdiag.analyses.margins.steps import advanced, combined
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.expressions import VariableValue

if TYPE_CHECKING:
    import numpy

    from cspdiag.analyses.margins.system import LinearizedProgram

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]

LARGEST_NUMBER_OF_INSTANTS = 20_000
"""A finer grid within one period is refused."""


class PeriodSimulation:
    """Follows one period; every number is a row of coefficients over the states at its beginning and the value at the
    cut.
    """

    def __init__(self, program: LinearizedProgram, cut: Cut) -> None:
        import numpy

        self.numpy = numpy
        self.program = program
        self.cut = cut
        feedback = program.search.of(cut.law)
        self.members = feedback.members
        self.period = program.search.period(cut.law)
        order = {name: k for k, name in enumerate(program.external)}

        def served(turn: Turn) -> tuple[tuple[int, ...], int]:
            return rank(turn), min((order[net.partition(".")[2]] for net in turn.inputs), default=len(order))

        self.turns = sorted(feedback.turns, key=served)
        self.laws = [
            part.law for turn in self.turns for part in turn.main if part.law is not None and part.law in self.members
        ]
        self.index_of: dict[tuple[str, Leaf], int] = {}
        plant = program.plant
        for leaf in (*plant.discrete, *plant.continuous):
            self.index_of["plant", leaf] = len(self.index_of)
        for leaf in plant.inputs:
            self.index_of["held", leaf] = len(self.index_of)
            self.index_of["latch", leaf] = len(self.index_of)
        for path in self.laws:
            program.check_operating_point(path, self.members)
            law = program.law(path)
            for leaf in (*law.discrete, *law.continuous):
                self.index_of[path, leaf] = len(self.index_of)
        for place in sorted(self.members & program.types.keys()):
            for indexes in leaves(program.types[place]):
                self.index_of["net", (place, indexes)] = len(self.index_of)
        size = len(self.index_of)
        self.state: dict[tuple[str, Leaf], Any] = dict(zip(self.index_of, numpy.eye(size, size + 1), strict=True))
        self.test = numpy.eye(size + 1)[size]
        self.zero = numpy.zeros(size + 1)
        self.computed: Any = self.zero
        self.sampled: dict[Leaf, Any] = {}
        self.offered: set[str] = set()
        """The channels with a value that has not been taken yet."""
        self._moves: dict[tuple[int, bool, int], Matrix] = {}

    def open_loop(self) -> OpenLoop:
        """Follow one period from tick to tick."""
        numpy = self.numpy
        environment = self.program.environment
        grid = Sampling(environment.step)
        periods = {turn.period for turn in self.turns} | {latch.period for latch in self._latches()}
        fine = gcd(environment.step, *periods)
        if self.period // fine > LARGEST_NUMBER_OF_INSTANTS:
            raise NotLinearError(
                f"a period has more than {LARGEST_NUMBER_OF_INSTANTS} instants of the environment", environment.span
            )
        runs = {t for period in periods for t in range(0, self.period, period)}
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
            self.period / 1e9,
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
        """When the outputs in the loop change that are handed over at ticks. Raises NotLinearError if that differs from
        one period to the next.
        """
        found = []
        for name in (name for net, name in self.program.outside.items() if net in self.members):
            port = self.program.external[name]
            if port.direction == "out" and port.sampling is not None and not port.immediate:
                if self.period % port.sampling.period:
                    raise NotLinearError(f"the period of the loop is not a multiple of that of `{name}`", port.span)
                found.append(port.sampling)
        return found

    def _handed_over(self) -> set[int]:
        """The instants at which outputs with an offset change."""
        return {t for latch in self._latches() if latch.offset for t in range(latch.offset, self.period, latch.period)}

    def _is_idle(self, instant: int) -> bool:
        """Whether only the plant changes at an instant."""
        turns = (Sampling(turn.period) for turn in self.turns)
        return not any(sampling.is_tick(instant) for sampling in (*self._latches(), *turns))

    def _tick(self, instant: int) -> None:
        plant = self.program.plant
        row = [self.state["plant", leaf] for leaf in (*plant.discrete, *plant.continuous)]
        row += [self.state["held", leaf] for leaf in plant.inputs]
        self.sampled = {
            leaf: combined(weights, row, self.zero)
            for leaf, weights in zip(plant.output_names, plant.outputs, strict=True)
        }
        for leaf in plant.inputs:
            port = self.program.external.get(leaf[0])
            if port is not None and port.sampling and port.sampling.is_tick(instant) and not port.immediate:
                self.state["held", leaf] = self.state["latch", leaf]
        running = [(turn, self._steps(turn)) for turn in self.turns if Sampling(turn.period).is_tick(instant)]
        while running:
            # Loops that only wait for each other's values compute the same in every order.
            waiting = [(turn, steps) for turn, steps in running if not self._continue(steps)]
            if len(waiting) == len(running):
                raise NotLinearError("its communications within a period wait for each other", waiting[0][0].loop.span)
            running = waiting
        for turn in self.turns:
            self._take(*turn.before, *turn.after)
        if self.offered:
            channel = min(self.offered).partition(".")[2]
            raise NotLinearError(f"no process takes the value of `{channel}` in each period", self.turns[0].loop.span)

    def _continue(self, steps: Iterator[None]) -> bool:
        """Continue a turn until it waits; whether it has ended."""
        return next(steps, "ended") is not None

    def _steps(self, turn: Turn) -> Iterator[None]:
        self._take(*turn.before)
        for part in turn.main:
            for net in self.program.search.turns.reads(part):
                if net in self.members and net in self.program.rendezvous:
                    while net not in self.offered:
                        yield
                    self.offered.discard(net)
            self._perform(part)
        self._take(*turn.after)

    def _take(self, *branches: tuple[Statement, ...]) -> None:
        for branch in branches:
            for net in self.program.search.turns.reads(branch[0]) if branch else ():
                if net in self.offered:
                    self.offered.discard(net)
                    for part in branch:
                        self._perform(part)

    def _perform(self, part: Statement) -> None:
        """Run a law, or move a value; what is not part of the loop stays constant."""
        if part.law is not None:
            if part.law in self.members:
                self._run(part.law)
        elif part.target in self.members:
            program = self.program
            moved: dict[tuple[int, ...], Any] = {}
            if part.value is None or isinstance(part.value, VariableValue):
                moved = {
                    indexes: self._value(part.sources[0], indexes) for indexes in leaves(program.types[part.target])
                }
            else:
                factors = coefficients(part, self.members, program.search.composition, program.parameters[part.process])
                rows = [self._value(place, ()) for place in factors]
                moved[()] = combined(list(factors.values()), rows, self.zero)
            for indexes, value in moved.items():
                self._store(part.target, indexes, value)
            self._offer(part.target)

    def _run(self, path: str) -> None:
        program = self.program
        law = program.law(path)
        states = (*law.discrete, *law.continuous)
        row = [self.state[path, leaf] for leaf in states]
        row += [self._value(program.net_of.get((path, name)), indexes) for name, indexes in law.inputs]
        outputs = [combined(weights, row, self.zero) for weights in law.outputs]
        following = advanced(law, row, program.search.period(path) / 1e9, self.zero)
        for leaf, value in zip(states, following, strict=True):
            self.state[path, leaf] = value
        for leaf, value in zip(law.output_names, outputs, strict=True):
            if (path, leaf) == (self.cut.law, self.cut.output):
                self.computed, value = value, self.test
            net = program.net_of.get((path, leaf[0]))
            if net in self.members:
                self._store(net, leaf[1], value)
        for name in dict.fromkeys(name for name, _ in law.output_names):
            net = program.net_of.get((path, name))
            if net in self.members:
                self._offer(net)

    def _value(self, place: str | None, indexes: tuple[int, ...]) -> Any:
        if place is None or place not in self.members:
            return self.zero
        port = self.program.outside.get(place)
        if port is not None and self.program.external[port].direction == "in":
            return self.sampled.get((port, indexes), self.zero)
        return self.state.get(("net", (place, indexes)), self.zero)

    def _store(self, place: str, indexes: tuple[int, ...], value: Any) -> None:
        if ("net", (place, indexes)) in self.state:
            self.state["net", (place, indexes)] = value
        port = self.program.outside.get(place)
        if port is None:
            return
        declared = self.program.external[port]
        kind = "latch" if declared.sampling is not None and not declared.immediate else "held"
        if (kind, (port, indexes)) in self.state:
            self.state[kind, (port, indexes)] = value

    def _offer(self, place: str) -> None:
        if place not in self.program.rendezvous:
            return
        if place in self.offered:
            raise NotLinearError(
                f"`{place.partition('.')[2]}` carries two values in one period", self.program.search.nets[place].span
            )
        self.offered.add(place)

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
            moved = advanced(plant, unit, duration / 1e9, numpy.zeros(len(keys)))
            kept = 0 if steps else len(plant.discrete)
            once = numpy.array([*unit[:kept], *moved[kept:], *unit[len(moved) :]])
            self._moves[key] = numpy.linalg.matrix_power(once, times)
        following = self._moves[key] @ numpy.array([self.state[one] for one in keys])
        self.state.update(zip(keys, following, strict=True))
