"""One run of the generated program along a trace, from gate to gate.

The trace determines which process continues, and what alternatives choose. Priorities and times are ignored.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import is_of_time_out, until_instant
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.verdict import LimitError, Limits
from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.deadlock.partners import report_deadlock
from cspdiag.runtime.deadlock.reports import DeadlockReport
from cspdiag.runtime.kernel.exceptions import Fault, ProcessError, Timeout
from cspdiag.runtime.kernel.policy import Option
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.runtime.network import Network as RunningNetwork
from cspdiag.simulate.run.execute import BodyError, account_of
from cspdiag.simulate.run.package import LoadedPackage
from cspdiag.verify.decisions import Decisions
from cspdiag.verify.guided.goal import STANDSTILLS
from cspdiag.verify.guided.result import GuidedRun
from cspdiag.verify.guided.script import Actor
from cspdiag.verify.replay.gates import Conductor, Gate, Interruption
from cspdiag.verify.replay.rest import Resting, resting
from cspdiag.verify.replay.result import Judge, Replay
from cspdiag.verify.replay.rounds import Rounds
from cspdiag.verify.replay.standstill import Standstill
from cspdiag.verify.runs.memory import memory
from cspdiag.verify.runs.names import UNFIT, WRITTEN, belongs, duration_of, fit, is_medium
from cspdiag.verify.runs.reachable import reachable_names
from cspdiag.verify.runs.recurrence import counting_to_faults
from cspdiag.verify.runs.trace import DivergenceError, Trace, TraceStep
from cspdiag.verify.runs.values import Values
from cspdiag.verify.runs.waiting import where_instead

_ALLOWED = "with the values that it has there, it does what the specification allows"
_NOTHING_DONE = (
    "in a round of that loop it only computes or abandons what waits, which the replay cannot recognize as repeated"
)
_AT_A_TIME = 1_000
_MOST_TURNS = 200
"""How often ``_AT_A_TIME`` processes may continue until all halt: 10,000 that begin do so a few times each."""
_SILENT = frozenset({"variable", "start", "end", "cancel", "exception", "failure", "delivered"})


class Attempt:
    """One run of the program along the trace, with given decisions about what the trace leaves open."""

    def __init__(
        self,
        network: CoreNetwork,
        package: LoadedPackage,
        trace: Trace,
        judge: Judge | None,
        values: Values,
        decisions: Decisions,
        rounds: Rounds | None,
        limits: Limits,
    ) -> None:
        self._judge = judge
        self._limits = limits
        self._rounds = rounds
        self._trace = trace
        self._package = package
        self._network = network
        self._decisions = decisions
        self.conductor = Conductor()
        self._ports = {f"{network.top}.{port.name}": port for port in network.external_ports}
        self._values = values
        self._communications: list[tuple[str, Any]] = []
        self._rest: Resting | None = None
        self._done = 0
        self._passed: dict[int, str] = {}
        self._actors: dict[int, tuple[Actor, ...]] = {}
        self.cycle = 0
        """The number of steps of processes before those that can be repeated."""
        self._round_from: int | None = None

    def run(self) -> Replay:
        """How far it comes."""
        self._decisions.begin()
        if self._rounds is not None:
            self._rounds.begin(self.conductor, self._values, self._decisions, self._settle)
        network = self._built()
        run = self.conductor.run = StepwiseRun(network, self.conductor, self._observe)
        deadlock, divergence, judgement = None, None, ""
        try:
            self._settle()
            for step in self._trace.steps:
                if self._rounds is not None:
                    self._rounds.reach(self._done, step)
                self._perform(step)
                self._done += 1
            if self._rounds is not None and not self._trace.cycle:
                self._rounds.bring_to_rest()
            self.cycle = len(self.conductor.passed)
            if self._trace.cycle:
                self._round_from = len(self._communications)
            for step in self._trace.cycle:
                self._perform(step)
                self._done += 1
            if self._trace.cycle and len(self.conductor.passed) == self.cycle:
                raise DivergenceError(_NOTHING_DONE)
            if self._trace.cycle:
                self._repeat_cycle(network.process)
            judgement = self._judged()
            deadlock = self._conclude()
        except DivergenceError as problem:
            divergence = str(problem)
        finally:
            run.close()
        added = () if self._rounds is None else tuple(self._rounds.added)
        return Replay(
            self._done,
            divergence,
            tuple(self._communications),
            deadlock,
            judgement=judgement,
            added=added,
            passed=self._passed,
            actors=self._actors,
            round_from=self._round_from,
        )

    def _built(self) -> RunningNetwork:
        try:
            network: RunningNetwork = self._package.module("network").build(defaultdict(lambda: self.conductor.outside))
        except Exception as problem:
            raise BodyError(account_of(problem)) from problem
        return network

    def _observe(self, channel: str, value: Any, writer: object, reader: object) -> None:
        self._communications.append((channel, value))

    def _settle(self) -> None:
        """Lets every process continue to a gate, or until it needs others."""
        turns = 0
        while self.conductor.run.run_ready(_AT_A_TIME):
            self._limits.check()
            turns += 1
            if turns > _MOST_TURNS:
                raise DivergenceError("it runs on and on, and never comes to rest")
        error = self.conductor.run.error
        if error is not None and (isinstance(error, Fault) or not isinstance(error, ProcessError)):
            if isinstance(error, LimitError):
                raise error
            raise DivergenceError(f"it ends with {type(error).__name__}: {error}")

    def _perform(self, step: TraceStep) -> None:
        if step.kind in _SILENT:
            return
        if step.kind == "internal":
            self._choose_silently(step)
            return
        if step.kind == "ready":
            self._choose_ready(step)
            return
        if step.kind in {"sample", "miss", "external"} and step.channel in self._ports:
            self._supply(step)
        self.conductor.done.clear()
        expected = []
        actors: list[Actor] = []
        for option, candidate in self._taking_part(step):
            if self._rounds is not None:
                actors.append(self._rounds.actor(candidate))
            if step.kind == "external" and step.value is None and option.value is not None:
                self._passed[self._done] = value_text(option.value, self._ports[step.channel].type)
            if isinstance(candidate, Interruption):
                candidate.fire()
            else:
                self.conductor.release(candidate, option)
            if step.kind == "time":
                self.conductor.passed[-1].words = until_instant(step.channel)
            expected.append((option.action, option.channel, candidate.task))
            self._settle()
        self._actors[self._done] = tuple(actors)
        for action, channel, task in expected:
            if action == "ready":
                self._read_after_guard(channel, task)
        for action, channel, _ in expected:
            if (action, channel) not in self.conductor.done and not step.channel.endswith(WRITTEN):
                raise DivergenceError(f"`{step}` does not happen{self._instead(step)}")

    def _choose_ready(self, step: TraceStep) -> None:
        """A process takes a guard that leaves the reading to the process, or abandons a body because a guard is ready.
        A guard that is alone in its alternative is not a choice.
        """
        path = step.parties[0][1]
        for option, candidate in self._offers(("ready", "read", "write"), step.channel):
            if not belongs(candidate.path, path):
                continue
            if isinstance(candidate, Interruption):
                is_seen = option.action != "ready" or step.channel not in self._ports
                (candidate.abandon if is_seen else candidate.fire)()
            elif option.action == "ready":
                self.conductor.release(candidate, option)
            else:
                continue
            self._settle()
            return

    def _offers(self, actions: tuple[str, ...], channel: str | None) -> list[tuple[Option, Gate | Interruption]]:
        """What the processes at gates could do."""
        gates = self.conductor.offering(actions, channel)
        candidates: list[Gate | Interruption] = [*gates, *self.conductor.interruptions]
        return [
            (option, candidate)
            for candidate in candidates
            for option in candidate.options
            if option.action in actions and channel in (None, option.channel)
        ]

    def _choose_silently(self, step: TraceStep, *, necessary: bool = False) -> bool:
        """A process takes a guard that is always ready, if it is at one. Returns whether it did. ``necessary``:
        otherwise the step cannot happen.
        """
        silent = [
            (option, candidate)
            for option, candidate in self._offers(("skip",), None)
            if any(belongs(candidate.path, path) for _, path in step.parties)
        ]
        optional = not necessary and any(_may_do_otherwise(candidate) for _, candidate in silent)
        chosen = self._decisions.choose(len(silent) + optional) if silent else 0
        if chosen == len(silent):
            return False
        option, candidate = silent[chosen]
        if isinstance(candidate, Interruption):
            candidate.fire()
        else:
            self.conductor.release(candidate, option)
        self._settle()
        return True

    def _read_after_guard(self, channel: str, task: Task) -> None:
        """A process whose guard was ready to read now reads: ``task``, or a branch of it."""
        own = self.conductor.halted.get(task)
        for gate in [own] if own is not None else list(self.conductor.halted.values()):
            for option in gate.options:
                if (option.action, option.channel) == ("read", channel):
                    self.conductor.release(gate, option)
                    self._settle()
                    return
        if ("read", channel) not in self.conductor.done:
            raise DivergenceError(f"no process reads `{channel}`")

    def _supply(self, step: TraceStep) -> None:
        port = self._ports[step.channel]
        if port.direction == "out":
            return
        if step.kind == "miss":
            self.conductor.outside.offered[step.channel] = Timeout(f"a sample of {step.channel} was overwritten")
            return
        candidates = self._values.candidates(port.type, step.value)
        if not candidates:
            raise DivergenceError(f"no value `{step.value}` can be offered at `{step.channel}`")
        value = self.conductor.outside.offered[step.channel] = candidates[self._decisions.choose(len(candidates))]
        self._passed[self._done] = value_text(value, port.type)

    def _taking_part(self, step: TraceStep) -> Iterator[tuple[Option, Gate | Interruption]]:
        """The gates to be passed for a step, writers first, alternatives last."""
        if step.kind == "time":
            offers = self._offers(("after",) if is_of_time_out(step.channel) else ("wait",), None)
            lasting = [entry for entry in offers if entry[0].duration == duration_of(step.channel)]
            offers = lasting or offers
        else:
            offers = self._offers(("write", "read", "ready"), step.channel.removesuffix(WRITTEN))
        found = list(self._chosen(step, offers))
        if not found:
            if self._choose_silently(step, necessary=True):
                return self._taking_part(step)
            raise DivergenceError(f"no process is ready for `{step}`{self._instead(step)}")
        return iter(sorted(found, key=lambda entry: _order(*entry)))

    def _chosen(
        self, step: TraceStep, offers: list[tuple[Option, Gate | Interruption]]
    ) -> Iterator[tuple[Option, Gate | Interruption]]:
        """What each process of the step continues with; a decision among several that fit."""
        taken: set[int] = set()
        for name, path in step.parties:
            if is_medium(name, step):
                continue
            free = [entry for entry in offers if id(entry[1].task) not in taken]
            ranks = [fit(candidate, name, path) for _, candidate in free]
            best = min(ranks, default=UNFIT)
            fitting = [entry for entry, rank in zip(free, ranks, strict=True) if rank == best < UNFIT]
            if fitting:
                option, candidate = fitting[self._decisions.choose(len(fitting))]
                taken.add(id(candidate.task))
                yield option, candidate

    def _instead(self, step: TraceStep) -> str:
        where = where_instead(step, self.conductor.run.root, self.conductor.names, self._network.top)
        return f": {where}" if where else ""

    def _repeat_cycle(self, process: object) -> None:
        """Repeats the cycle until a round leaves everything as it was, so it can be repeated forever; the first may
        only lead there.

        If the proof left nothing open, values that only decide whether something faults do not count.
        """
        matters = counting_to_faults(self._network) if self._trace.exact else None
        if matters is not None and not matters:
            return
        before = memory(process)
        first, second = self._round_from or 0, len(self._communications)
        for step in self._trace.cycle:
            self._perform(step)
        if self._communications[second:] == self._communications[first:second]:
            del self._communications[second:]
        else:
            self._round_from = second
        after = memory(process)
        changed = [
            name for name, value in before.items() if after.get(name) != value and (matters is None or name in matters)
        ]
        if changed:
            named = ", ".join(f"`{name}`" for name in changed[:3])
            raise DivergenceError(f"in each round, {named} changes, so this may end")

    @property
    def ends(self) -> bool:
        """Whether the judge was shown that all processes have ended."""
        return self._judge is not None and self._rest is None

    def led(self, run: GuidedRun, result: Replay) -> Replay:
        """The result of this attempt, after the program was led along what the attempt found."""
        divergence, judgement = run.divergence, result.judgement
        if run.succeeded and self._judge is not None:
            found = self._judge(run.communications, self._rest_of(run))
            divergence, judgement = (_ALLOWED, "") if found is None else (None, found)
        communications = result.communications if self._trace.cycle else run.communications
        as_it_runs = run.communications[: len(communications)] == communications
        return replaced(
            result,
            divergence=divergence,
            communications=communications,
            deadlock=run.deadlock,
            excluded=not run.succeeded,
            judgement=judgement,
            other=run.happened,
            other_round_from=run.round_from,
            standing=run.standing,
            instants=run.instants[: len(communications)] if as_it_runs else (),
            repeated=run.repeated,
        )

    def _rest_of(self, run: GuidedRun) -> Resting | None:
        """What the processes offer after the run: the same as here, unless they have made more rounds there."""
        here, there = (Counter(channel for channel, _ in made) for made in (self._communications, run.communications))
        return self._rest if here == there else Resting((), can_continue=True)

    def _judged(self) -> str:
        """What the judge finds wrong with this attempt."""
        if self._judge is None:
            return ""
        if not self.conductor.run.root.ended:
            self._rest = resting([*self.conductor.halted.values(), *self.conductor.interruptions], self._ports)
        judgement = self._judge(self._communications, self._rest)
        if judgement is None:
            raise DivergenceError(_ALLOWED)
        return judgement

    def _conclude(self) -> DeadlockReport | None:
        """Raises DivergenceError unless what was refuted is now the case."""
        if self._trace.failure not in STANDSTILLS:
            return None
        if self.conductor.run.root.ended:
            raise DivergenceError("it ends instead of getting stuck")
        standstill = Standstill(self.conductor, self._trace, self._decisions, self._ports, self._settle)
        standstill.end_silently()
        before = len(self._communications)
        standstill.try_to_continue()
        if len(self._communications) > before:
            channel, _ = self._communications[before]
            raise DivergenceError(f"it continues with `{channel}`")
        return report_deadlock(self.conductor.run.root, self.conductor.run.now, names_in=reachable_names)


def _order(option: Option, candidate: Gate | Interruption) -> tuple[bool, bool]:
    return isinstance(candidate, Interruption) or len(candidate.options) > 1, option.action == "write"


def _may_do_otherwise(candidate: Gate | Interruption) -> bool:
    """Whether a process that has a guard that is always ready may continue otherwise."""
    return isinstance(candidate, Interruption) or any(option.action != "skip" for option in candidate.options)
