"""The timing of a program: from its network to response times, latencies and advice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import lcm

from cspdiag.analyses.timing.flow.behaviours import Behaviour, behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.demands import Demand, Demands, merged
from cspdiag.analyses.timing.flow.partners import Partners, Together
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.flow.restarts import again
from cspdiag.analyses.timing.flow.spinning import Spinning
from cspdiag.analyses.timing.flow.value_flow import Passing, Stage
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.report.chains import chains
from cspdiag.analyses.timing.report.outputs import Outputs, port_names
from cspdiag.analyses.timing.result import Chain, LoopTiming, TimingReport
from cspdiag.analyses.timing.task import ONCE, Task
from cspdiag.analyses.timing.tasks import edf
from cspdiag.analyses.timing.tasks.assignment import feasible_order
from cspdiag.analyses.timing.tasks.response import Response, response_time, response_times
from cspdiag.analyses.timing.tasks.witness import find_witness, is_overloaded
from cspdiag.analyses.timing.threads.graph import Thread
from cspdiag.analyses.timing.threads.offers import capacities
from cspdiag.analyses.timing.threads.threads import Threads
from cspdiag.base import Span
from cspdiag.base.record import replaced
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import CoreNetwork

LARGEST_NUMBER_OF_ROUNDS = 50
"""Rounds after which response times that depend on each other are given up."""


@dataclass
class _Loop:
    """A sampled loop of a thread before it is analysed."""

    name: str
    owner: Behaviour
    waits: tuple[int, ...]
    period: int
    span: Span
    jobs: list[Job]
    together: Together
    delays: int
    delayed: int
    has_one_step: bool


def timing_report(network: CoreNetwork, measured: Mapping[str, int] | None = None) -> TimingReport:
    """Analyse the sampled loops of a program.

    Execution times are those that its submodels and processes state by ``wcet``, or the ``measured`` ones, in
    nanoseconds by path. What processes themselves do between laws counts nothing unless they state a time. Whatever has
    no bound is refused, with the reason.
    """
    threads = Threads(network, measured or {})
    used = tuple(sorted(set(measured or {}) & set(threads.instances)))
    shifted = list(_shifted_inputs(network))
    refusals = [*shifted, *threads.unseen]
    every = list(threads.root.with_forks())
    levels = {priority: k for k, priority in enumerate(sorted({_level(thread) for thread in every}))}
    found = [behaviour(k, thread, levels[_level(thread)], refusals) for k, thread in enumerate(every)]
    behaviours = [one for one in found if one is not None]
    if any(thread.has_samples() for thread in every):
        refusals += Spinning(every).refusals()
    order = {path: k for k, path in enumerate(threads.instances)}
    missing = tuple(sorted(threads.missing.values(), key=lambda part: order[part.leaf]))
    # What is unknown counts nothing: the rest of the figures would only mislead.
    analysis = _analysis(network, every, behaviours, refusals, are_loops_known=not (missing or shifted))
    rows = analysis.rows(network, refusals)
    tasks = tuple(analysis.tasks())
    recurring = [task for task in tasks if task.period < ONCE]
    inputs = {f"{network.top}.{name}": k for k, name in enumerate(port_names(network.external_ports))}
    found_chains, are_all_chains = ([], True) if missing or refusals else analysis.chains(network, rows)
    is_late = not all(row.is_met for row in rows)
    overloaded = is_overloaded(every, behaviours)
    return TimingReport(
        network.top,
        tuple(rows),
        tuple(found_chains),
        missing,
        tuple(dict.fromkeys(refusals)),
        tasks,
        sum(task.utilization for task in recurring),
        lcm(*(row.period for row in rows), *(task.period for task in recurring)) if rows else 0,
        False if overloaded else (True if analysis.is_independent and edf.meets_deadlines(recurring) else None),
        _advice(network, every, behaviours, recurring) if is_late and not refusals else None,
        used,
        are_all_chains,
        find_witness(every, behaviours, inputs) if is_late and not shifted else None,
        overloaded,
    )


def _shifted_inputs(network: CoreNetwork) -> Iterator[Refusal]:
    """Jobs are taken to begin together, at the multiples of their periods."""
    for name, port in zip(port_names(network.external_ports), network.external_ports, strict=True):
        if port.direction == "in" and port.sampling is not None and port.sampling.offset:
            yield Refusal(
                name, "its samples have an offset, which the timing analysis does not follow", port.span,
                f"let it be sampled {Sampling(port.sampling.period).every}; an output may have an offset",
            )  # fmt: skip


def _analysis(
    network: CoreNetwork,
    every: Sequence[Thread],
    behaviours: Sequence[Behaviour],
    refusals: list[Refusal],
    *,
    are_loops_known: bool = True,
) -> _Analysis:
    """The loops of a program and what they ask of each other, with the priorities that its threads have."""
    grid = min((environment.step for environment in network.environments), default=None)
    demands = Demands(behaviours, grid, capacities(network), again(every, behaviours, grid), refusals)
    surroundings = Contention(every, demands.own)
    order = {instance.path: k for k, instance in enumerate(network.instances)}
    loops = sorted(
        (loop for one in behaviours for loop in _loops(one, demands, surroundings, refusals)),
        key=lambda loop: order.get(loop.name, len(order)),
    )
    waited = {one.number: _waited_between(one, demands, surroundings, refusals) for one in behaviours}
    return _Analysis(surroundings, behaviours, demands, loops if are_loops_known else [], waited)


def _advice(
    network: CoreNetwork, every: Sequence[Thread], behaviours: Sequence[Behaviour], tasks: Sequence[Task]
) -> tuple[str, ...] | None:
    """Another order of priorities of the branches of one parallel, if it is proved to meet every deadline."""
    order = feasible_order(tasks)
    branches = [one for one in behaviours if not one.thread.forks]
    known = {one.thread.path: one for one in branches}
    groups = {id(group) for thread in every for group in thread.forks}
    if order is None or len(groups) != 1 or len(known) != len(branches):
        return None
    paths = tuple(dict.fromkeys(tasks[k].name for k in order))
    if set(paths) != set(known):
        return None
    ranked = [replace(one, level=paths.index(one.thread.path) if one.thread.path in known else 0) for one in behaviours]
    refusals: list[Refusal] = []
    rows = _analysis(network, every, ranked, refusals).rows(network, refusals)
    is_met = not refusals and all(row.is_met for row in rows)
    return tuple(path.partition(".")[2] or path for path in paths) if is_met else None


def _level(thread: Thread) -> tuple[int, ...]:
    """Ranks from the outermost prioritized parallel inwards, compared as if padded with zeros."""
    priority = thread.priority
    while priority and priority[-1] == 0:
        priority = priority[:-1]
    return priority


def _waited_between(
    one: Behaviour, demands: Demands, surroundings: Contention, refusals: list[Refusal]
) -> tuple[int, int]:
    """How much partners compute at most for what a thread does between its samples, and the level of the least urgent
    of them.
    """
    longest, level = 0, one.level
    for job in one.jobs:
        if job.is_owed and job.path.meets and job.offer is not None and job.offer.kind != "sample":
            partners = Partners(demands, surroundings, one, 0, one.thread.places[job.wait].span, refusals)
            together = partners.together(job.path)
            longest, level = max(longest, together.work - job.path.work), max(level, together.level)
    return longest, level


def _loops(one: Behaviour, demands: Demands, surroundings: Contention, refusals: list[Refusal]) -> Iterator[_Loop]:
    """The sampled loops of a thread: those waits for samples that it comes back to, or after which it follows their
    inputs further.
    """
    grouped: dict[tuple[str, int], list[Job]] = {}
    for job in one.jobs:
        if job.offer is None or job.offer.kind != "sample":
            continue
        if job.wait in one.loop_of or job.offer.period in job.path.keeps:
            of_wait = [
                other for other in one.at(job.wait)
                if other.offer is not None and other.offer.kind == "sample" and other.offer.period == job.offer.period
            ]  # fmt: skip
            heaviest = max(of_wait, key=lambda other: other.path.heaviest[0]).path.heaviest
            name = heaviest[1] or one.thread.places[job.wait].path
            grouped.setdefault((name, job.offer.period), []).append(job)
    for (name, period), jobs in grouped.items():
        span = one.thread.places[jobs[0].wait].span
        partners = Partners(demands, surroundings, one, period, span, refusals)
        pieces = [partners.together(job.path) for job in jobs]
        together = max(pieces, key=lambda piece: piece.work)
        together.step = max(piece.step for piece in pieces)
        together.level = max(piece.level for piece in pieces)
        for piece in pieces:
            together.members |= piece.members
            together.replaced |= piece.replaced
        alone = len(together.members) == 1
        yield _Loop(
            name, one, tuple(dict.fromkeys(job.wait for job in jobs)), period, span, jobs, together,
            max(job.path.delays for job in jobs),
            max(job.path.delayed for job in jobs),
            alone and all(not job.path.switches for job in jobs),
        )  # fmt: skip


class _Analysis:
    def __init__(
        self,
        surroundings: Contention,
        behaviours: Sequence[Behaviour],
        demands: Demands,
        loops: Sequence[_Loop],
        waited: Mapping[int, tuple[int, int]],
    ) -> None:
        self.behaviours = {one.number: one for one in behaviours}
        self.demands = demands
        self.surroundings = surroundings
        self.loops = loops
        self.waited = waited
        """By thread, how much partners compute for what it does between its samples, and at which level."""
        self.lateness: dict[int, int] = {}
        """By thread, how late what its samples cause in others may come."""
        self._causing = {part.origin for parts in demands.own.values() for part in parts if part.late}
        self._waiting = {loop.owner.number for loop in loops if loop.delays or len(loop.together.members) > 1}
        self._waiting |= {number for number, parts in demands.own.items() for part in parts if part.held or part.meets}
        self._tasks: dict[Demand, Task] = {}
        self._together: dict[tuple[int, int], dict[int, Response]] = {}

    @property
    def is_independent(self) -> bool:
        """Whether no loop waits for another one, or for time, nor causes work in another."""
        return not (self._waiting or self._causing)

    def rows(self, network: CoreNetwork, refusals: list[Refusal]) -> list[LoopTiming]:
        """Every loop with its bound; rounds until those that wait for each other agree."""
        outputs = Outputs(network)
        matters = self._waiting or any(loop.owner.number in self._causing for loop in self.loops)
        for _ in range(LARGEST_NUMBER_OF_ROUNDS):
            rows = [self._row(outputs, loop) for loop in self.loops]
            lateness: dict[int, int] = {}
            for loop, row in zip(self.loops, rows, strict=True):
                late = loop.period if row.response is None else min(row.response, loop.period)
                lateness[loop.owner.number] = max(late, lateness.get(loop.owner.number, 0))
            if lateness == self.lateness or not matters:
                return rows
            self._come_late(lateness)
        # Nothing of a loop that is in time comes later than a period after its tick: if all are even so, the bounds
        # hold.
        most = dict(self.lateness)
        for loop in self.loops:
            most[loop.owner.number] = max(loop.period, most[loop.owner.number])
        self._come_late(most)
        rows = [self._row(outputs, loop) for loop in self.loops]
        if not all(row.is_met for row in rows):
            reason = "the response times of its loops depend on each other and do not settle"
            refusals.append(Refusal(network.top, reason, self.loops[0].span, "use fewer rendezvous between loops"))
        return rows

    def _come_late(self, lateness: dict[int, int]) -> None:
        self.lateness = lateness
        self._tasks.clear()
        self._together.clear()

    def _row(self, ports: Outputs, loop: _Loop) -> LoopTiming:
        task = self.task(loop)
        response = self._response(loop, task)
        jobs = [*loop.jobs, *self._of_partners(loop)]
        written = frozenset(net for job in jobs for net in job.path.outputs)
        leaves = frozenset(leaf for job in jobs for leaf in job.path.leaves)
        places = frozenset(loop.owner.thread.places[wait].path for wait in loop.waits)
        outputs = ports.names(written)
        return LoopTiming(
            loop.name.partition(".")[2] or loop.name, loop.owner.thread.path, loop.span, loop.period,
            loop.together.level,
            loop.together.work, task.step, response.blocking, response.worst, response.start,
            outputs, ports.interval(written, loop.period, response.worst),
            tuple(
                self.behaviours[k].thread.path.partition(".")[2]
                for k in sorted(loop.together.members - {loop.owner.number})
            ),
            leaves | places, task,
        )  # fmt: skip

    def _response(self, loop: _Loop, task: Task) -> Response:
        """The bound of a loop; those of a parallel of which each is alone in its branch are found together."""
        number = loop.owner.number
        group = self.surroundings.group_of(number)
        alone = self.surroundings.below(number)
        beside = self._beside_own(loop)
        if (
            group is not None
            and not beside
            and len(alone) == 1
            and replaced(self._as_task(alone[0]), name=task.name) == task
        ):
            if group not in self._together:
                parts = self.surroundings.together(group)
                found = response_times([self._as_task(part) for part in parts])
                self._together[group] = {part.thread: response for part, response in zip(parts, found, strict=True)}
            return self._together[group][number]
        others = [self._as_task(part) for part in self.surroundings.beside(number, loop.together.replaced)]
        if any(part.held or part.meets for part in beside):
            # It comes back to the queue when others have come to it, and to partners that are less urgent.
            task = replaced(task, final=0, priority=max(task.priority, self.waited[number][1]))
        below = max((other.step for other in others if other.priority > task.priority), default=0)
        return response_time(task, [*others, *(self._as_own(part, below) for part in merged([beside]))])

    def _of_partners(self, loop: _Loop) -> list[Job]:
        """The jobs of partners that follow no samples of their own: what they write belongs to the loop."""
        partners = [self.behaviours[number] for number in loop.together.members]
        return [job for one in partners if not one.has_samples for job in one.jobs if job.wait in one.waits]

    def chains(self, network: CoreNetwork, rows: Sequence[LoopTiming]) -> tuple[list[Chain], bool]:
        """How values pass through the loops, and whether that is complete."""
        bounded = [(loop, row.response) for loop, row in zip(self.loops, rows, strict=True) if row.response is not None]
        stages = [self._stage(loop, response) for loop, response in bounded]
        passing = Passing(network, self.behaviours, stages)
        return chains(passing, stages, [loop.name for loop, _ in bounded], Outputs(network).latency)

    def _stage(self, loop: _Loop, response: int) -> Stage:
        wait = loop.waits[0]
        stage = Stage(loop.period, response, (loop.owner.number, loop.owner.loop_of.get(wait, -1 - wait)))
        stage.jobs[loop.owner.number] = list(loop.jobs)
        for number in loop.together.members:
            one = self.behaviours[number]
            if not one.has_samples:
                stage.jobs[number] = [job for job in one.jobs if job.wait in one.waits]
        stage.spots = {
            (number, place) for number, jobs in stage.jobs.items() for job in jobs for place in job.path.moves
        }
        return stage

    def task(self, loop: _Loop) -> Task:
        """The loop with its partners as a task."""
        together = loop.together
        final = together.work if loop.has_one_step else 0
        # Time that it lets pass is as good as work to itself, and leaves the processor to others.
        return Task(
            loop.name, loop.period, together.work + loop.delayed, loop.period, together.level,
            step=min(together.step, together.work),
            final=final, suspensions=loop.delays,
        )  # fmt: skip

    def _as_task(self, part: Demand) -> Task:
        found = self._tasks.get(part)
        if found is None:
            found = self._tasks[part] = self._made_task(part)
        return found

    def _made_task(self, part: Demand) -> Task:
        jitter = 0
        if part.late:
            jitter = self.lateness.get(part.origin, part.period)
        elif part.origin == part.thread and self._waiting & {part.thread, *part.shared}:
            # Waiting for partners or for time delays the rest of its work.
            latest = max(self.lateness.get(number, 0) for number in (part.thread, *part.shared))
            jitter = max(0, latest - part.work)
        jitter += part.behind
        thread = self.behaviours[part.thread].thread
        return Task(
            thread.path, part.period, part.work, part.period, part.level, jitter=jitter, step=part.step,
            final=part.work if part.step == part.work else 0, suspensions=part.delays,
        )  # fmt: skip

    def _as_own(self, part: Demand, below: int) -> Task:
        """What a thread does between its samples, to itself.

        Time that it lets pass is as good as work, after which a step ``below`` may have begun; and what comes later may
        be served first.
        """
        task = self._as_task(part)
        held = part.held + part.delays * below + part.meets * self.waited[part.thread][0]
        return replaced(task, work=task.work + held, final=0 if held else task.final, priority=-1)

    def _beside_own(self, loop: _Loop) -> list[Demand]:
        """What else the loop's own thread may want to do while the loop does."""
        return [
            part for part in self.demands.own[loop.owner.number]
            if (part.period < ONCE and (part.origin != loop.owner.number or part.late))
            or self._of_same_loop(loop, part)
        ]  # fmt: skip

    def _of_same_loop(self, loop: _Loop, part: Demand) -> bool:
        """Samples of another period that the same loop follows."""
        if part.origin != loop.owner.number or part.late or part.period == loop.period:
            return False
        places = (loop.owner.thread.places[wait] for wait in loop.owner.waits)
        return any({part.period, loop.period} <= place.periods() for place in places)

    def tasks(self) -> list[Task]:
        """What the whole program demands at most at any time."""
        return [self._as_task(part) for part in self.surroundings.everything()]
