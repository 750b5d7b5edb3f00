"""Follows at compile time what a program does: all its tasks, their channels and the time, by the scheduling rules of the language.

Values are not known, but for variables that only count. What happens is written down: computations, samples that are taken, values that pass. Where
the program goes on depends on a value that is not known, ``decisions`` say where to go; without one for it, following stops there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd, ProcessScope
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.network.ir.network import ExternalPort, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.fuse.begin import delay, exchange, selection
from cspdiag.optimize.fuse.code import (
    Close,
    Code,
    Communicate,
    Compute,
    Decide,
    Delay,
    Finish,
    Handler,
    Jump,
    NotStaticError,
    Raise,
    Scope,
    Select,
    Start,
)
from cspdiag.optimize.fuse.media import AtOnce, Medium, SampledInput, channel_medium
from cspdiag.optimize.fuse.record import Recorder
from cspdiag.optimize.fuse.requests import Exchange, Selection
from cspdiag.optimize.fuse.tasks import Branches, Request, Task

LONGEST = 1000
"""Turns of tasks that are followed at most; a schedule that is longer would not be worth its memory."""


@record
class Ends:
    """The program ends, by an exception if ``failure`` is not None."""

    failure: Raise | None


@record
class Loops:
    """The program is in a state for the second time; it was in it at instant ``since``, when ``position`` things had happened."""

    position: int
    since: int


@record
class Asks:
    """What follows depends on a condition."""

    condition: Expression


Outcome: TypeAlias = Ends | Loops | Asks


class _FoundError(Exception):
    def __init__(self, outcome: Outcome) -> None:
        super().__init__()
        self.outcome = outcome


class Following(Recorder):
    """The state of a program at an instant, and what has happened so far."""

    def __init__(
        self, code: Code, ports: Sequence[ExternalPort], counting: frozenset[str], decisions: Sequence[bool]
    ) -> None:
        super().__init__(code.entry, counting)
        self.code = code
        self.due = 0
        self.ready: list[Task] = []
        self.waiting: list[Request] = []
        self.running: Task | None = None
        self.memories: dict[str, int] = {}
        self.failure: Raise | None = None
        self._decisions = decisions
        self._asked = 0
        self._seen: dict[object, tuple[int, int]] = {}
        self._tasks: list[Task] = []
        self._owners = _owners(code.entry)
        self.media: dict[tuple[str, int | None], Medium] = {}
        self.inputs: list[SampledInput] = []
        self._make_media(code.entry, ports)
        self._waited_at = [medium for medium in self.media.values() if not isinstance(medium, AtOnce)]
        self.period = math.lcm(*(port.period for port in self.inputs)) if self.inputs else 1

    def _make_media(self, entry: ProcessClass, ports: Sequence[ExternalPort]) -> None:
        ends = [end for end in entry.creation if isinstance(end, PortEnd | ChannelEnd)]
        for channel in entry.channels:
            readers: list[End] = [e for e in ends if isinstance(e, ChannelEnd) and e.channel == channel.name]
            self.media[channel.name, None] = channel_medium(self, channel, readers)
        for port in ports:
            name = port.name.partition("[")[0]
            readers = [e for e in ends if isinstance(e, PortEnd) and (e.port, e.index) == (name, port.index)]
            if port.direction == "in" and port.period is not None:
                sampled = SampledInput(self, port.name, port.period, readers)
                self.media[name, port.index] = sampled
                if readers:
                    self.inputs.append(sampled)
            elif port.direction == "out":
                self.media[name, port.index] = AtOnce(self, port.name)

    def medium_of(self, end: End) -> Medium:
        """What an end belongs to. Raises NotStaticError where that is an input without a period."""
        key = (end.port, end.index) if isinstance(end, PortEnd) else (end.channel, None)
        medium = self.media.get(key)
        if medium is None:
            raise NotStaticError(f"nobody knows when {key[0]} has an event")
        return medium

    def run(self) -> Outcome:
        """Follows to the end, to a state that has been before, or to where a decision is missing. Raises NotStaticError."""
        main = self._task((0,), 0, (), None)
        self.make_ready(main)
        try:
            while True:
                self._run_all_ready()
                if main.ended:
                    return Ends(self.failure)
                self._instant(self._next_instant())
        except _FoundError as found:
            return found.outcome

    def _task(self, key: tuple[int, ...], position: int, priority: tuple[int, ...], parent: Branches | None) -> Task:
        task = Task(key, position, priority, parent)
        self._tasks.append(task)
        return task

    def followed_since(self) -> dict[End, int]:
        """When the ends of sampled inputs were read, or waited at, for the first time."""
        return {end: since for port in self.inputs for end, since in port.since.items()}

    def make_ready(self, task: Task) -> None:
        """Put into the ready queue, where it is not there yet."""
        if task is not self.running and task not in self.ready and not task.ended:
            self.ready.append(task)

    def cancel(self, task: Task) -> None:
        """The task ends when it runs next: what it would still compute until its next communication, nobody sees."""
        if task.ended or task.cancelled:
            return
        task.cancelled = True
        if task.request is not None and not task.request.done:
            task.request.abandon()

    def notice(self) -> None:
        """Wake whoever may go on now."""
        for request in list(self.waiting):
            task = request.task
            asleep = task is not self.running and task not in self.ready and not task.cancelled
            if asleep and request in self.waiting and not request.done and request.may_go_on():
                self.make_ready(task)

    def follows(self, end: End, period: int) -> bool:
        """Whether the process of an end followed a period before the present tick, through another end."""
        owner = self._owners.get(end)
        return any(
            port.follows(other)
            for port in self.inputs
            if port.period == period
            for other in port.sessions
            if self._owners.get(other) == owner
        )

    def _run_all_ready(self) -> None:
        while self.ready:
            self._remember()
            task = min(self.ready, key=Task.rank)
            self.ready.remove(task)
            self.running = task
            self._run(task)
            self.running = None
            self.notice()
            self._tasks = [task for task in self._tasks if not task.ended]

    def _remember(self) -> None:
        """Stops where the program is in a state for the second time."""
        state = self._state()
        before = self._seen.get(state)
        if before is not None:
            position, since = before
            if since == self.now and position == len(self.happenings):
                raise NotStaticError("it goes on for ever without doing anything")
            raise _FoundError(Loops(position, since))
        if len(self._seen) > LONGEST:
            raise NotStaticError(f"it takes more than {LONGEST} turns until it repeats")
        self._seen[state] = (len(self.happenings), self.now)

    def _state(self) -> object:
        return (
            None if self.running is None else self.running.key,
            self.now % self.period,
            tuple(task.key for task in self.ready),
            tuple(task.state() for task in self._tasks),
            tuple(request.task.key for request in self.waiting),
            tuple(medium.state() for medium in self._waited_at),
            tuple(sorted(self.memories.items())),
            self.knowledge(),
        )

    def _run(self, task: Task) -> None:
        request = task.request
        if request is not None:
            if not request.done and not task.cancelled:
                request.attempt()
            if not request.done and not (task.cancelled and not isinstance(request, Branches)):
                return
            self.waiting.remove(request)
            task.request = None
        if task.cancelled:
            self._end(task, None)
            return
        if request is not None and not self._go_on(task, request):
            return
        while self._execute(task):
            pass

    def _go_on(self, task: Task, request: Request) -> bool:
        """After what it waited for; gives whether it goes on."""
        self.resumed(task.key)
        match request:
            case Branches(failure=Raise() as failure):
                return self._raise(task, failure)
            case Branches():
                task.position = request.after
            case Selection():
                instruction = self.code.instructions[task.position]
                assert isinstance(instruction, Select)
                assert request.chosen is not None
                task.position = instruction.bodies[request.chosen]
            case _:
                task.position += 1
        return True

    def _execute(self, task: Task) -> bool:
        """One instruction; gives whether the task goes on."""
        self.count_instruction()
        instruction = self.code.instructions[task.position]
        match instruction:
            case Compute(action=action):
                self.compute_action(action)
                task.position += 1
            case Decide():
                holds = self._holds(instruction)
                self._jump(task, task.position + 1 if holds else instruction.otherwise)
            case Jump(to=to):
                self._jump(task, to)
            case Raise():
                return self._raise(task, instruction)
            case Close(scope=scope):
                self._process_ended(scope)
                task.position += 1
            case Finish():
                self._end(task, None)
                return False
            case Start():
                return self._start(task, instruction)
            case Communicate():
                return self._begin(task, exchange(self, task, instruction))
            case Delay():
                return self._begin(task, delay(self, task, instruction))
            case Select():
                return self._begin(task, selection(self, task, instruction.choice))
        return True

    def _jump(self, task: Task, to: int) -> None:
        back = to <= task.position
        task.position = to
        if back:
            self._remember()

    def _holds(self, decide: Decide) -> bool:
        value = self.folded(decide.condition)
        if isinstance(value, LiteralValue):
            return value.value is True
        if self._asked == len(self._decisions):
            raise _FoundError(Asks(decide.condition))
        taken = self._decisions[self._asked]
        self._asked += 1
        self.turn(decide.condition, taken)
        return taken

    def _begin(self, task: Task, request: Request) -> bool:
        task.request = request
        self.waiting.append(request)
        if isinstance(request, Exchange):
            request.begin()
        if not request.done:
            request.attempt()
        self.notice()
        if not request.done:
            return False
        self.waiting.remove(request)
        task.request = None
        return self._go_on(task, request)

    def _start(self, task: Task, instruction: Start) -> bool:
        request = Branches(self, task, instruction.after)
        task.request = request
        self.waiting.append(request)
        for number, position in enumerate(instruction.branches):
            priority = (*task.priority, number) if instruction.prioritized else task.priority
            request.tasks.append(self._task((*task.key, task.position, number), position, priority, request))
        for branch in request.tasks:
            self.make_ready(branch)
        return False

    def _raise(self, task: Task, failure: Raise) -> bool:
        for item in self.code.around[task.position]:
            match item:
                case Scope(process=process):
                    self._process_ended(process)
                case Handler(exception=caught, handler=handler) if caught == failure.action.exception:
                    task.position = handler
                    return True
        self._end(task, failure)
        return False

    def _end(self, task: Task, failure: Raise | None) -> None:
        task.ended = True
        self.forget(task.key)
        if task.cancelled:
            for item in self.code.around[task.position]:
                if isinstance(item, Scope):
                    self._process_ended(item.process)
        if task.parent is not None:
            task.parent.branch_ended(failure, task.cancelled)
        else:
            self.failure = failure

    def _process_ended(self, process: ProcessScope) -> None:
        if process.ends:
            self.process_ended(process)
        instance = process.instance
        for port in self.inputs:
            port.sessions = {end: s for end, s in port.sessions.items() if self._owners.get(end) != instance}

    def _next_instant(self) -> int:
        deadlines = [deadline for request in self.waiting for deadline in request.deadlines()]
        followed = [port for port in self.inputs if port.sessions]
        if not deadlines and not any(port.offers for port in self.inputs):
            raise NotStaticError("it deadlocks")
        return min([*deadlines, *((self.now // port.period + 1) * port.period for port in followed)])

    def _instant(self, now: int) -> None:
        self.count_instruction()
        self.now = now
        for port in self.inputs:
            if now % port.period == 0:
                port.sampled()
                self.notice()
        self.due = now
        self.notice()


def _owners(entry: ProcessClass) -> Mapping[End, str]:
    """The process, of those that are inside, that has an end."""
    scopes = (part for part in parts(entry.body) if isinstance(part, ProcessScope))
    return {end: scope.instance for scope in scopes for end in scope.ends}
