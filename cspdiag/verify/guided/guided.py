"""Leads the program, on its real runtime, along a counterexample."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.verdict import Limits
from cspdiag.runtime.network import Network as RunningNetwork
from cspdiag.simulate.run.execute import BodyError, account_of
from cspdiag.simulate.run.package import LoadedPackage
from cspdiag.verify.decisions import Decisions, RandomDecisions
from cspdiag.verify.guided.goal import Goal
from cspdiag.verify.guided.result import GuidedRun
from cspdiag.verify.guided.run import Run
from cspdiag.verify.guided.script import Passed, Script, put_off
from cspdiag.verify.guided.world import Lines, World
from cspdiag.verify.runs.recurrence import Recurrence
from cspdiag.verify.runs.stuck import Partners
from cspdiag.verify.runs.trace import Trace
from cspdiag.verify.runs.values import Values, numbers_of

MOST_ACTIONS = 100_000
"""The number of actions of processes in all runs together."""
MOST_RUNS = 600
"""All together."""
MOST_OF_ONE_KIND = 80
"""The number of runs that follow one script strictly, and of those that follow it while other processes continue."""
MOST_ROUNDS = 24
"""How many rounds of what can be repeated forever are run until times repeat themselves."""
MOST_AT_RANDOM = 40
"""The number of runs that follow no script."""
AT_LEAST = 2_000
"""The number of actions that every run may have, even if others have used up all."""
FOR_EACH_ENTRY = 4
"""As many times the entries of a script are also allowed for every run: a round of a large ring has more than
``AT_LEAST``, and what is repeated has to be run twice until it repeats itself.
"""


class Guided:
    """Runs of the program of a network, compiled to a package without optimization."""

    def __init__(self, network: CoreNetwork, package: LoadedPackage, limits: Limits) -> None:
        self._limits = limits
        self._network = network
        self._package = package
        types = package.module("types") if network.enums or network.structs else None
        values = Values(types, numbers_of(network))
        inputs = [port for port in network.external_ports if port.direction == "in"]
        self._defaults = {
            f"{network.top}.{port.name}": next(iter(values.candidates(port.type, None)), None) for port in inputs
        }
        self._events = frozenset(f"{network.top}.{port.name}" for port in inputs if port.sampling is None)
        self._outside = frozenset(f"{network.top}.{port.name}" for port in network.external_ports)
        environments = network.environments
        counts = bool(environments) and all(environment.on_miss != "timeout" for environment in environments)
        self._on_miss: Literal["timeout", "count"] = "count" if counts else "timeout"
        self._partners = Partners(network)
        self._left = MOST_ACTIONS
        self._runs_left = MOST_RUNS

    @property
    def exhausted(self) -> bool:
        """Whether no further run is to be tried."""
        return self._left <= 0 or self._runs_left <= 0

    def follow(
        self, entries: Sequence[Passed], trace: Trace, cycle: int, *, ends: bool, further: bool = False
    ) -> GuidedRun:
        """A run that reaches the goal of the entries, which with ``ends`` is the end of all processes, or the run that
        gets furthest; entries from ``cycle`` on are repeated until the times repeat themselves.

        ``further``: processes have made more rounds than the trace says. Others may do so meanwhile, even if a
        specification sees it, and what is offered once is offered late.
        """
        if further:
            entries = (*put_off(entries[:cycle], self._events), *entries[cycle:])
        period = len(entries) - cycle if trace.cycle else 0
        script = (*entries, *(tuple(entries[cycle:]) * MOST_ROUNDS if period else ()))
        visible = frozenset(name for name in self._outside if not trace.hides(name))
        goal = Goal(
            trace,
            self._outside,
            visible,
            cycle if trace.cycle else len(script),
            period,
            ends,
            self._partners,
            Recurrence(self._network, exact=trace.exact),
            further,
        )
        best: GuidedRun | None = None
        for run in self._runs(script, goal, max(AT_LEAST, FOR_EACH_ENTRY * len(entries))):
            if run.succeeded:
                return run
            if best is None or (bool(run.happened), run.done) > (bool(best.happened), best.done):
                best = run
        assert best is not None
        return best

    def _runs(self, script: Sequence[Passed], goal: Goal, actions: int) -> Iterator[GuidedRun]:
        """First with the default decisions, then strictly following the script, then with decisions of every kind until
        one reaches a standstill. Each may have this number of ``actions``.
        """
        first = self._run(script, goal, Decisions(), strict=False, actions=actions)
        others = bool(first.happened)
        yield first
        kinds = ((False, False),) if goal.further else ((True, False), (True, True), (False, False))
        for strict, late in kinds:
            decisions = Decisions()
            for _ in range(MOST_OF_ONE_KIND):
                if others and not strict:
                    return
                run = self._run(script, goal, decisions, strict=strict, late=late, actions=actions)
                others = others or bool(run.happened)
                yield run
                if self.exhausted or not decisions.advance(run.cut):
                    break

    def at_random(self, trace: Trace) -> GuidedRun | None:
        """A run to a deadlock that follows no script; None if none was found."""
        goal = Goal(
            trace,
            self._outside,
            self._outside - trace.hidden,
            0,
            0,
            ends=False,
            partners=self._partners,
            recurrence=Recurrence(self._network, exact=trace.exact),
        )
        runs = (
            self._run((), goal, RandomDecisions(number), strict=False, free=True) for number in range(MOST_AT_RANDOM)
        )
        return next((run for run in runs if run.happened), None)

    def _run(
        self,
        script: Sequence[Passed],
        goal: Goal,
        decisions: Decisions,
        *,
        strict: bool,
        late: bool = False,
        free: bool = False,
        actions: int = AT_LEAST,
    ) -> GuidedRun:
        self._limits.check()
        decisions.begin()
        lines = Lines()
        limit = max(actions, self._left // 4)
        network = self._built(lines)
        wanted = Script(script)
        world = World(network.ports, lines, wanted, self._defaults, self._on_miss)
        run = Run(network, wanted, world, goal, decisions, strict=strict, free=free, late=late, limit=limit).run()
        self._left -= run.actions
        self._runs_left -= 1
        return run

    def _built(self, lines: Lines) -> RunningNetwork:
        try:
            network: RunningNetwork = self._package.module("network").build(lines)
        except Exception as problem:
            raise BodyError(account_of(problem)) from problem
        return network
