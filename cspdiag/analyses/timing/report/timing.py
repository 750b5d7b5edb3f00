"""The timing of a program: from its network to response times, latencies and advice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import lcm

from cspdiag.analyses.timing.flow.behaviours import Behaviour, behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.demands import Demand, Demands, merged
from cspdiag.analyses.timing.flow.restarts import restart_intervals
from cspdiag.analyses.timing.flow.spinning import Spinning
from cspdiag.analyses.timing.flow.steady import may_pause
from cspdiag.analyses.timing.flow.value_flow import ValueFlow
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.report.chains import chains
from cspdiag.analyses.timing.report.loops import Loop, loops_of, work_of_partners
from cspdiag.analyses.timing.report.outputs import Outputs, port_names
from cspdiag.analyses.timing.report.stages import stage_of
from cspdiag.analyses.timing.result import Chain, LoopTiming, TimingReport
from cspdiag.analyses.timing.task import ONCE, Task, last_in_time
from cspdiag.analyses.timing.tasks import edf
from cspdiag.analyses.timing.tasks.assignment import feasible_order
from cspdiag.analyses.timing.tasks.kernel import kernel_tasks
from cspdiag.analyses.timing.tasks.response import Response, response_time, response_times
from cspdiag.analyses.timing.tasks.witness import find_witness, is_overloaded
from cspdiag.analyses.timing.threads.graph import Thread
from cspdiag.analyses.timing.threads.offers import capacities
from cspdiag.analyses.timing.threads.threads import Threads
from cspdiag.base.record import replaced
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import CoreNetwork

LARGEST_NUMBER_OF_ROUNDS = 50
"""The number of iterations after which response times that depend on each other are considered unbounded."""


def timing_report(network: CoreNetwork, measured: Mapping[str, int] | None = None, *, kernel: int = 0) -> TimingReport:
    """Analyse the sampled loops of a program.

    Execution times are those that its submodels and processes state by ``wcet``, or the ``measured`` ones, in
    nanoseconds by path. Computation between the laws of a process is neglected unless the process states a time.
    Whatever has no bound is refused, with the reason. ``kernel`` is the longest time, in nanoseconds, that the kernel
    was seen to need at an instant, device functions included.
    """
    threads = Threads(network, measured or {})
    used = tuple(sorted(set(measured or {}) & set(threads.instances)))
    shifted = list(_shifted_inputs(network))
    refusals = [*shifted, *threads.unseen]
    all_threads = list(threads.root.with_forks())
    levels = {priority: k for k, priority in enumerate(sorted({_level(thread) for thread in all_threads}))}
    found = [behaviour(k, thread, levels[_level(thread)], refusals) for k, thread in enumerate(all_threads)]
    behaviours = [one for one in found if one is not None]
    if any(thread.has_samples() for thread in all_threads):
        refusals += Spinning(all_threads).refusals()
    order = {path: k for k, path in enumerate(threads.instances)}
    missing = tuple(sorted(threads.missing.values(), key=lambda part: order[part.leaf]))
    # Unknown times would count as zero, and the other figures would mislead.
    of_kernel = kernel_tasks(network, kernel, threads.channel_ends.constant, refusals)
    outside = of_kernel.all
    analysis = _analysis(network, all_threads, behaviours, refusals, outside, are_loops_known=not (missing or shifted))
    rows = analysis.rows(network, refusals)
    tasks = tuple(analysis.tasks())
    recurring = [task for task in tasks if task.period < ONCE]
    # A loop that computes nothing demands no time, but is late behind a long step all the same.
    deadlines = [*recurring, *(row.task for row in rows if not row.work)]
    inputs = {f"{network.top}.{name}": k for k, name in enumerate(port_names(network.external_ports))}
    found_chains, are_all_chains = ([], True) if missing or refusals else analysis.chains(network, rows)
    rows = [_without_old_values(row, found_chains) for row in rows]
    is_late = not all(row.is_met for row in rows)
    overloaded = is_overloaded(all_threads, behaviours)
    is_free = analysis.is_independent and not outside
    return TimingReport(
        network.top,
        tuple(rows),
        tuple(found_chains),
        missing,
        tuple(dict.fromkeys(refusals)),
        tasks,
        sum(task.utilization for task in (*recurring, *outside)),
        lcm(*(row.period for row in rows), *(task.period for task in recurring)) if rows else 0,
        # The kernel is more urgent than any deadline.
        False if overloaded else (True if is_free and edf.meets_deadlines(deadlines) else None),
        _advice(network, all_threads, behaviours, recurring, outside) if is_late and not refusals else None,
        used,
        are_all_chains,
        find_witness(all_threads, behaviours, inputs) if is_late and not shifted else None,
        overloaded,
        kernel,
        of_kernel.ticks,
    )


def _without_old_values(row: LoopTiming, found: Sequence[Chain]) -> LoopTiming:
    """A loop without a latency if its outputs may be based on kept values of any age."""
    is_old = any(chain.age is None and chain.sink in row.outputs for chain in found)
    return replaced(row, latency=None) if is_old else row


def _shifted_inputs(network: CoreNetwork) -> Iterator[Refusal]:
    """Refuse inputs with an offset: the analysis assumes that all jobs begin together, at the multiples of their
    periods.
    """
    for name, port in zip(port_names(network.external_ports), network.external_ports, strict=True):
        if port.direction == "in" and port.sampling is not None and port.sampling.offset:
            yield Refusal(
                name, "its samples have an offset, which the timing analysis does not follow", port.span,
                f"let it be sampled {Sampling(port.sampling.period).every}; an output may have an offset",
            )  # fmt: skip


def _analysis(
    network: CoreNetwork,
    all_threads: Sequence[Thread],
    behaviours: Sequence[Behaviour],
    refusals: list[Refusal],
    outside: Sequence[Task],
    *,
    are_loops_known: bool = True,
) -> _Analysis:
    """The loops of a program and what they demand of each other, with the priorities of its threads."""
    grid = min((environment.step for environment in network.environments), default=None)
    demands = Demands(behaviours, grid, capacities(network), restart_intervals(all_threads, behaviours, grid), refusals)
    contention = Contention(all_threads, demands.by_thread)
    order = {instance.path: k for k, instance in enumerate(network.instances)}
    by_number = {one.number: one for one in behaviours}
    loops = sorted(
        (loop for one in behaviours for loop in loops_of(one, by_number, demands, contention, refusals)),
        key=lambda loop: order.get(loop.name, len(order)),
    )
    partner_work = {one.number: work_of_partners(one, demands, contention, refusals) for one in behaviours}
    return _Analysis(contention, by_number, demands, loops if are_loops_known else [], partner_work, outside)


def _advice(
    network: CoreNetwork,
    all_threads: Sequence[Thread],
    behaviours: Sequence[Behaviour],
    tasks: Sequence[Task],
    outside: Sequence[Task],
) -> tuple[str, ...] | None:
    """Another order of priorities of the branches of one parallel composition, if it is proved to meet every
    deadline.
    """
    order = feasible_order(tasks)
    branches = [one for one in behaviours if not one.thread.forks]
    known = {one.thread.path: one for one in branches}
    groups = {id(group) for thread in all_threads for group in thread.forks}
    if order is None or len(groups) != 1 or len(known) != len(branches):
        return None
    paths = tuple(dict.fromkeys(tasks[k].name for k in order))
    if set(paths) != set(known):
        return None
    ranked = [replace(one, level=paths.index(one.thread.path) if one.thread.path in known else 0) for one in behaviours]
    refusals: list[Refusal] = []
    rows = _analysis(network, all_threads, ranked, refusals, outside).rows(network, refusals)
    is_met = not refusals and all(row.is_met for row in rows)
    return tuple(path.partition(".")[2] or path for path in paths) if is_met else None


def _level(thread: Thread) -> tuple[int, ...]:
    """Ranks from the outermost prioritized parallel composition inwards, compared as if padded with zeros."""
    priority = thread.priority
    while priority and priority[-1] == 0:
        priority = priority[:-1]
    return priority


class _Analysis:
    def __init__(
        self,
        contention: Contention,
        behaviours: Mapping[int, Behaviour],
        demands: Demands,
        loops: Sequence[Loop],
        partner_work: Mapping[int, tuple[int, int]],
        outside: Sequence[Task],
    ) -> None:
        self.behaviours = behaviours
        self.demands = demands
        self.contention = contention
        self.loops = loops
        self.partner_work = partner_work
        """By thread, how much partners compute for what it does between its samples, and the level of the
        least urgent.
        """
        self.outside = outside
        """The tasks that are not those of processes."""
        self.lateness: dict[int, int] = {}
        """By thread, how late the work may be released that its samples trigger in others."""
        self._causing = {part.origin for parts in demands.by_thread.values() for part in parts if part.is_triggered}
        self._waiting = {loop.owner.number for loop in loops if loop.delays or len(loop.joint_work.members) > 1}
        self._waiting |= {
            number for number, parts in demands.by_thread.items() for part in parts if part.suspension or part.meets
        }
        self._tasks: dict[Demand, Task] = {}
        self._by_group: dict[tuple[int, int], dict[int, Response]] = {}

    @property
    def is_independent(self) -> bool:
        """Whether no loop waits for another one, or for time, or triggers work in another."""
        return not (self._waiting or self._causing)

    def rows(self, network: CoreNetwork, refusals: list[Refusal]) -> list[LoopTiming]:
        """Every loop with its bound, iterated until the bounds of loops that wait for each other are consistent."""
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
            self._set_lateness(lateness)
        # What a loop that is in time triggers comes at most a period after its tick: if all loops are in time under
        # this assumption, the bounds hold.
        most = dict(self.lateness)
        for loop in self.loops:
            most[loop.owner.number] = max(loop.period, most[loop.owner.number])
        self._set_lateness(most)
        rows = [self._row(outputs, loop) for loop in self.loops]
        if not all(row.is_met for row in rows):
            reason = "the response times of its loops depend on each other and do not settle"
            refusals.append(Refusal(network.top, reason, self.loops[0].span, "use fewer rendezvous between loops"))
        return rows

    def _set_lateness(self, lateness: dict[int, int]) -> None:
        self.lateness = lateness
        self._tasks.clear()
        self._by_group.clear()

    def _row(self, ports: Outputs, loop: Loop) -> LoopTiming:
        task = self.task(loop)
        response = self._response(loop, task)
        jobs = [job for jobs in loop.jobs_by_thread.values() for job in jobs]
        written = frozenset(net for job in jobs for net in job.path.outputs)
        leaves = frozenset(leaf for job in jobs for leaf in job.path.leaves)
        places = frozenset(loop.owner.thread.places[wait].path for wait in loop.waits)
        outputs = ports.names(written)
        return LoopTiming(
            loop.name.partition(".")[2] or loop.name, loop.owner.thread.path, loop.span, loop.period,
            loop.joint_work.level,
            loop.joint_work.work, task.step, response.blocking, response.worst, response.start,
            outputs, ports.interval(written, loop.period, response.worst, loop.written_in_each_sample),
            tuple(
                self.behaviours[k].thread.path.partition(".")[2]
                for k in sorted(loop.joint_work.members - {loop.owner.number})
            ),
            leaves | places, task,
        )  # fmt: skip

    def _response(self, loop: Loop, task: Task) -> Response:
        """The bound of a loop; loops that are alone in the branches of a parallel composition are bounded together."""
        number = loop.owner.number
        group = self.contention.group_of(number)
        alone = self.contention.of_subtree(number)
        beside = self._other_demands_of_thread(loop)
        if (
            group is not None
            and not beside
            and len(alone) == 1
            and replaced(self._as_task(alone[0]), name=task.name) == task
        ):
            if group not in self._by_group:
                parts = self.contention.of_group(group)
                found = response_times([*(self._as_task(part) for part in parts), *self.outside])
                self._by_group[group] = {part.thread: response for part, response in zip(parts, found, strict=False)}
            return self._by_group[group][number]
        others = [self._as_task(part) for part in self.contention.in_parallel_with(number, loop.joint_work.included)]
        if any(part.suspension or part.meets for part in beside):
            # It may rejoin the queue behind others, and wait for less urgent partners.
            task = replaced(task, final=0, priority=max(task.priority, self.partner_work[number][1]))
        below = max((other.step for other in others if other.priority > task.priority), default=0)
        own = (self._as_own_task(part, below) for part in merged([beside]))
        return response_time(task, [*others, *own, *self.outside])

    def chains(self, network: CoreNetwork, rows: Sequence[LoopTiming]) -> tuple[list[Chain], bool]:
        """The chains of values through the loops, and whether these are all."""
        bounded = [(loop, row.response) for loop, row in zip(self.loops, rows, strict=True) if row.response is not None]
        stages = [stage_of(loop, response, self.contention) for loop, response in bounded]
        pausing = {number for number, one in self.behaviours.items() if may_pause(one, self.contention)}
        flow = ValueFlow(network, self.behaviours, stages, pausing)
        return chains(flow, stages, [loop.name for loop, _ in bounded], Outputs(network).latency)

    def task(self, loop: Loop) -> Task:
        """The loop with its partners as a task."""
        joint_work = loop.joint_work
        final = joint_work.work if loop.has_one_step else 0
        # To the loop itself the time that it lets pass is work, though others may use the processor.
        return Task(
            loop.name, loop.period, joint_work.work + loop.delay_time, last_in_time(loop.period), joint_work.level,
            step=min(joint_work.step, joint_work.work),
            final=final, suspensions=loop.delays,
        )  # fmt: skip

    def _as_task(self, part: Demand) -> Task:
        found = self._tasks.get(part)
        if found is None:
            found = self._tasks[part] = self._new_task(part)
        return found

    def _new_task(self, part: Demand) -> Task:
        jitter = 0
        if part.is_triggered:
            jitter = self.lateness.get(part.origin, part.period)
        elif part.origin == part.thread and self._waiting & {part.thread, *part.shared_with}:
            # Waiting for partners or delays postpones the rest of its work.
            latest = max(self.lateness.get(number, 0) for number in (part.thread, *part.shared_with))
            jitter = max(0, latest - part.work)
        jitter += part.jitter
        thread = self.behaviours[part.thread].thread
        return Task(
            thread.path, part.period, part.work, last_in_time(part.period), part.level, jitter=jitter, step=part.step,
            final=part.work if part.step == part.work else 0, suspensions=part.delays,
        )  # fmt: skip

    def _as_own_task(self, part: Demand, below: int) -> Task:
        """What a thread does between its samples, as interference with its own loop.

        Time that it lets pass counts as work, after which a step of length ``below`` may have begun; and what is
        released later may be served first.
        """
        task = self._as_task(part)
        suspension = part.suspension + part.delays * below + part.meets * self.partner_work[part.thread][0]
        return replaced(task, work=task.work + suspension, final=0 if suspension else task.final, priority=-1)

    def _other_demands_of_thread(self, loop: Loop) -> list[Demand]:
        """What else the thread of a loop may demand while the loop runs."""
        return [
            part for part in self.demands.by_thread[loop.owner.number]
            if (part.period < ONCE and (part.origin != loop.owner.number or part.is_triggered))
            or self._of_same_loop(loop, part)
        ]  # fmt: skip

    def _of_same_loop(self, loop: Loop, part: Demand) -> bool:
        """Whether a demand is that of samples with another period in the same loop."""
        if part.origin != loop.owner.number or part.is_triggered or part.period == loop.period:
            return False
        places = (loop.owner.thread.places[wait] for wait in loop.owner.waits)
        return any({part.period, loop.period} <= place.periods() for place in places)

    def tasks(self) -> list[Task]:
        """What the program demands at most at any time, as tasks."""
        return [self._as_task(part) for part in self.contention.of_program()]
