"""A run of the program on its real runtime, led along a counterexample.

It obeys the rules of every run: a process runs until it must wait, processes of higher priority run first, delays end
on time, samples arrive at the ticks of their periods, and time passes only while no process is ready or a submodel
computes. The guide decides which of the ready processes of one level is next, which of the ready guards of ``[]`` is
taken, how long a submodel computes, and what arrives from outside, and when. What another attempt does differently is
in ``Decisions``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NoReturn

from cspdiag.proofs.verdict import LimitError
from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.deadlock.partners import report_deadlock
from cspdiag.runtime.kernel.durations import shown
from cspdiag.runtime.kernel.exceptions import Fault, ProcessError, RunEnded
from cspdiag.runtime.kernel.party import Party
from cspdiag.runtime.kernel.policy import Option, Policy
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.runtime.network import Network as RunningNetwork
from cspdiag.verify.decisions import Decisions
from cspdiag.verify.guided.goal import Goal
from cspdiag.verify.guided.ready import ReadyParties
from cspdiag.verify.guided.repetition import Repetition
from cspdiag.verify.guided.result import GuidedRun
from cspdiag.verify.guided.script import Actor, Happened, Passed, Script, Standing, is_option, to_first_round, words_of
from cspdiag.verify.guided.world import World
from cspdiag.verify.runs.reachable import reachable_names
from cspdiag.verify.runs.task_names import Key, TaskNames, path_of, task_of
from cspdiag.verify.runs.task_places import TaskPlaces

_TRIED = "in the runs that were tried"
_LEFT_OUT = ", and proofs leave {} out"


class AstrayError(Exception):
    """The run does not reach the goal; the message says why."""


class _Enough(RunEnded):
    """Ends a process that runs forever without ever having to wait; nothing in that process catches it."""


class Run(Policy):
    """One run. ``strict``: no process does anything that is not in the script; ``free``: there is no script; ``late``:
    what everything waits for may arrive later than at once.
    """

    def __init__(
        self,
        network: RunningNetwork,
        script: Script,
        world: World,
        goal: Goal,
        decisions: Decisions,
        *,
        strict: bool,
        free: bool,
        late: bool,
        limit: int,
    ) -> None:
        self._script = script
        self._world = world
        self._goal = goal
        self._decisions = decisions
        self._strict = strict
        self._free = free
        self._late = late
        self._limit = limit
        self._network = network
        self._outputs = goal.outside - world.inputs
        self._expected = goal.expected() if goal.trace.failure == "refinement" else None
        self._seen = 0
        self._names = TaskNames()
        self._places = TaskPlaces()
        self._keys: dict[Task, Key] = {}
        self._ready = ReadyParties(self._rank)
        self._steps = 0
        self._communications: list[tuple[str, Any]] = []
        self._instants: list[int] = []
        self._happened: list[Happened] = []
        self._broadcasts: set[str] = set()
        self._problem: str | None = None
        self._lost: str | None = None
        self._cut: int | None = None
        self._cycle_began: int | None = None
        self._repetition = Repetition(goal, world, network)
        self._besides = False
        self._broken_off = False

    def run(self) -> GuidedRun:
        """Runs until the goal is reached or missed; the decisions have begun."""
        run = self._run = StepwiseRun(self._network, self, self._observe)
        self._world.begin(run)
        divergence, deadlock = None, None
        happened: tuple[Happened, ...] = ()
        standing: tuple[Standing, ...] = ()
        try:
            self._go()
            if self._goal.is_standstill and (
                self._free or self._script.left or not self._goal.has_expected_waits(self._run.root)
            ):
                divergence, happened = self._lost or self._unreached(), tuple(self._happened)
                standing = tuple(self._goal.standing(self._run.root, self._names))
            if self._goal.is_standstill:
                stuck = self._goal.stuck(self._run.root)
                deadlock = report_deadlock(self._run.root, self._run.now, stuck, self._called, reachable_names)
        except AstrayError as problem:
            divergence = self._lost or str(problem)
        finally:
            run.close()
        done = len(self._script.entries) - self._script.left
        cut = self._cut if self._strict and self._cut is not None else self._decisions.made
        made, instants = tuple(self._communications), tuple(self._instants)
        round_from = None
        if divergence is None and self._besides and self._goal.shows_round(self._happened[self._repetition.period]):
            happened, round_from = to_first_round(self._happened, self._repetition.period)
        return GuidedRun(
            done,
            self._actions,
            divergence,
            made,
            deadlock,
            cut,
            happened,
            standing,
            instants,
            self._repetition.found,
            round_from,
        )

    def _called(self, task: Task) -> str:
        return self._goal.called(task, self._names)

    def _go(self) -> None:
        while self._script.left or self._goal.is_standstill or self._is_unfinished():
            self._offer()
            party = self._next()
            if party is None:
                if self._concluded():
                    return
                self._pass_time()
                continue
            self._steps += 1
            try:
                self._run.run_one(party)
            except _Enough:
                assert self._broken_off
            if self._repetition.found is not None:
                return
            if self._broken_off:
                if self._script.left or self._goal.is_standstill:
                    raise AstrayError(self._unreached(_TRIED))
                return
            if isinstance(self._run.error, LimitError):
                raise self._run.error
            if self._failed:
                raise AstrayError(f"it ends with {type(self._run.error).__name__}: {self._run.error}")
            if self._problem is not None:
                raise AstrayError(self._problem)
            if self._actions > self._limit:
                raise AstrayError(self._unreached(_TRIED))
            if self._has_repeated():
                return
        if self._goal.period:
            raise AstrayError("times or values change in each round, so this may end")

    def _has_repeated(self) -> bool:
        """Whether all further rounds will be like the past one."""
        number = self._script.next()
        done = len(self._script.entries) if number is None else number
        if not self._repetition.is_due(done):
            return False
        if self._goal.trace.failure == "livelock" and self._cycle_began not in (None, self._run.now):
            raise AstrayError("time passes before everything is repeated")
        return self._repetition.look(self._run.root, self._run.now, len(self._happened))

    @property
    def _actions(self) -> int:
        return self._steps + self._world.met

    @property
    def _failed(self) -> bool:
        """Whether the program has ended too early, or by an exception unknown to proofs."""
        known = isinstance(self._run.error, ProcessError) and not isinstance(self._run.error, Fault)
        return self._run.error is not None and (not known or self._script.left > 0 or self._goal.is_standstill)

    def _is_unfinished(self) -> bool:
        """Whether the last event that a specification is to see, or the end, has not been reached although all
        processes have done their part once.
        """
        if self._goal.ends:
            return not self._run.root.ended
        return self._goal.further and self._expected is not None and self._seen < len(self._expected)

    def _concluded(self) -> bool:
        """No process is ready: whether that is the standstill."""
        if self._run.root.ended:
            raise AstrayError("it ends instead of getting stuck" if not self._script.left else self._unreached())
        if not self._goal.is_standstill or (self._script.left and self._strict):
            return False
        missed = self._goal.missed(self._run.root, self._names)
        if (
            missed is None
            and self._goal.trace.failure != "deadlock"
            and not self._goal.has_expected_waits(self._run.root)
        ):
            missed = "the processes that wait are not those of the counterexample"
        if missed is not None and not self._script.left and not self._world.time_can_pass:
            raise AstrayError(missed)
        return missed is None

    def _next(self) -> Party | None:
        """The next process: of the highest level that has any, the one that the script needs first, or as decided."""
        for level, party in self._run.take_ready():
            self._ready.add(level, party)
        return self._ready.take(self._decisions)

    def _rank(self, party: Party) -> int:
        return self._script.rank(self._key(party))

    def _key(self, party: Party) -> Key:
        task = task_of(party)
        found = self._keys.get(task)
        if found is None:
            found = self._keys[task] = self._names.key(task)
        return found

    def _offer(self) -> None:
        """The environment offers what is needed next."""
        number = self._script.next()
        if number is None or not self._world.can_offer(self._script.entries[number]):
            return
        later = self._run.has_ready or bool(self._ready) or self._world.time_can_pass
        if not later:
            self._offer_alone(self._script.entries[number])
        elif not self._decisions.choose(2):
            self._world.offer(self._script.entries[number])

    def _offer_alone(self, entry: Passed) -> None:
        """The environment offers what everything waits for. Which samples come next depends on when that is."""
        if self._late:
            instants = self._world.ticks
            self._world.wait_until(instants[self._decisions.choose(len(instants))])
        self._world.offer(entry)

    def arrives(self, task: Party) -> None:
        """See ``Policy.arrives``: what the task needs from outside may arrive just before."""
        head = self._script.head(self._key(task))
        if head is None or not self._world.can_offer(head):
            return
        number = self._script.next()
        is_next = number is not None and self._script.entries[number] is head
        if is_next or self._decisions.choose(2):
            self._world.offer(head)

    def _pass_time(self) -> None:
        """No process is ready: time advances to the next instant, or something arrives from outside."""
        instant = self._world.next_instant() if self._world.time_can_pass else None
        if instant is not None:
            self._world.meet(instant)
            return
        entry = next(filter(self._world.can_offer, self._script.undone()), None)
        if entry is None:
            raise AstrayError(self._unreached())
        self._offer_alone(entry)

    def computes(self) -> None:
        """See ``Policy.computes``."""
        instants = self._world.computing
        self._world.pass_until(instants[self._decisions.choose(len(instants))] if len(instants) > 1 else instants[0])

    def choose(self, task: Party, ready: Sequence[Option], *, prioritized: bool) -> int:
        """See ``Policy.choose``."""
        head = self._script.head(self._key(task))
        wanted = None if head is None else next((n for n, option in enumerate(ready) if is_option(head, option)), None)
        if prioritized:
            if head is not None and wanted:
                words = (
                    f"`{head.name or head.path}` prefers `{ready[0].channel or ready[0].action}` to `{words_of(head)}`"
                )
                self._lose(words + _LEFT_OUT.format("priorities"))
            return 0
        if wanted is not None:
            return wanted
        return 0 if self._strict or len(ready) == 1 else self._decisions.choose(len(ready))

    def did(self, task: Party, option: Option) -> None:
        """See ``Policy.did``; communications are reported by ``took_part``."""
        if option.channel:
            return
        action, duration = option.action, option.duration
        self._note(action, "", duration, task)
        self._match(task, action, "", option.index)
        is_over_at_once = action == "skip" or (action in ("wait", "after") and duration <= 0)
        if is_over_at_once and self._has_repeated():
            self._break_off()

    def took_part(self, party: Party, action: Literal["read", "write", "miss"], channel: str) -> None:
        """See ``Policy.took_part``."""
        if action == "write":
            self._broadcasts.add(channel)
        self._note(action, channel, 0, party)
        self._match(party, action, channel)

    def _break_off(self) -> NoReturn:
        """Ends the running process, which would never have to wait; the scheduler notifies its parent."""
        self._broken_off = True
        raise _Enough

    def _note(self, action: str, channel: str, value: Any, *parties: Party | None) -> None:
        self._steps += 1
        if self._actions > self._limit:
            self._break_off()
        tasks = [task_of(party) for party in parties if party is not None]
        current = self._run.current
        actors = tuple(
            Actor(path_of(task), self._names.possible_names(task), self._places.of(task, current)) for task in tasks
        )
        self._happened.append(Happened(action, channel, actors, value))

    def _match(self, party: Party, action: str, channel: str, index: int = 0) -> bool:
        """Whether the script has this next, which is then done."""
        key = self._key(party)
        number = self._script.do(key, action, channel, index)
        if number is not None:
            if number >= self._goal.cycle and self._cycle_began is None:
                self._cycle_began = self._run.now
            return True
        head = self._script.head(key)
        self._besides = self._besides or head is not None or self._cycle_began is None
        if head is not None or self._strict:
            self._lose(self._other(party, channel or action, head))
        return False

    def _other(self, party: Party, done: str, head: Passed | None) -> str:
        words = f"at {shown(self._run.now)}, `{self._names.called(task_of(party))}` continues with `{done}`"
        if head is not None:
            words += f" before `{words_of(head)}`"
        timed = head is not None and head.action in {"wait", "after"}
        return words + _LEFT_OUT.format("priorities" if self._run.has_levels and not timed else "times")

    def _lose(self, words: str) -> None:
        """Notes that the run does something else than the script."""
        if self._goal.further:
            return
        if self._cut is None:
            self._lost, self._cut = words, self._decisions.made
        if self._strict:
            self._problem = self._lost

    def _unreached(self, when: str = "") -> str:
        number = self._script.next()
        if number is None:
            return f"it does not get stuck {when}".rstrip()
        entry = self._script.entries[number]
        when = when or f": at {shown(self._run.now)} nothing can continue"
        return f"`{entry.name or entry.path}` does not reach `{words_of(entry)}`{'' if when[0] == ':' else ' '}{when}"

    def wrote(self, party: Party, channel: str, value: Any) -> None:
        """See ``Policy.wrote``."""
        self._communicated(channel, value)
        self._note("communication", channel, value, party)
        self._match(party, "write", channel)

    def _observe(self, channel: str, value: Any, writer: Party | None, reader: Party | None) -> None:
        if channel in self._outputs:
            return
        self._communicated(channel, value)
        self._note("communication", channel, value, writer, reader)
        wanted = set()
        if writer is not None and channel not in self._broadcasts:
            wanted.add(self._match(writer, "write", channel))
        if reader is not None:
            wanted.add(self._match(reader, "read", channel))
        if self._goal.further and len(wanted) > 1:
            self._problem = f"at {shown(self._run.now)}, `{channel}` is communicated with another process"

    def _communicated(self, channel: str, value: Any) -> None:
        is_expected = self._expected is not None and channel in self._goal.visible
        if self._expected is not None and is_expected and self._seen == len(self._expected) and not self._goal.ends:
            # What went wrong has already happened.
            return
        self._communications.append((channel, value))
        self._instants.append(self._run.now)
        if self._expected is None or not is_expected:
            return
        expected = self._expected[self._seen] if self._seen < len(self._expected) else None
        if channel != expected and self._goal.further:
            return
        self._seen += 1
        if channel != expected:
            self._problem = f"at {shown(self._run.now)}, `{channel}` comes before `{expected or 'the end'}`"
            self._problem += _LEFT_OUT.format("priorities" if self._run.has_levels else "times")
