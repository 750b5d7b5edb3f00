"""From a network to its threads."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, assert_never

from cspdiag.analyses.timing.ends import Ends, never_waits
from cspdiag.analyses.timing.flow import Missing, Move, Offer, Place, Thread
from cspdiag.analyses.timing.looping import Looping
from cspdiag.network.actions import (
    Action,
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    ChannelEnd,
    Choice,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OptimizedStep,
    OutputEvent,
    ParallelSteps,
    PortEnd,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    Step,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.expressions import Expression, VariableValue
from cspdiag.network.ir import Connection, Declared, Network, ProcessClass, SubmodelClass
from cspdiag.network.walk import parts


@dataclass(frozen=True)
class _Context:
    """Where an action stands: its thread and process, what ends it early, and the stated time that replaces those inside."""

    thread: Thread
    path: str
    priority: tuple[int, ...]
    handlers: tuple[tuple[str, int], ...] = ()
    interrupts: tuple[Offer, ...] = ()
    stated: int | None = None
    groups: tuple[int, ...] = ()


class Threads:
    """The threads of a network. ``missing`` are the laws without a worst-case execution time; ``measured`` gives times by path, in nanoseconds,
    that count instead of stated ones.
    """

    def __init__(self, network: Network, measured: Mapping[str, int]) -> None:
        self.network = network
        self.measured = measured
        self.classes = {entry.name: entry for entry in network.classes}
        self.instances = {instance.path: instance for instance in network.instances}
        self.ends = Ends(network)
        self.missing: dict[str, Missing] = {}
        self._groups = 0
        self._looping = Looping(network)
        self.root = Thread(network.top, ())
        entry = self.classes[self.instances[network.top].class_name]
        context = _Context(self.root, network.top, ())
        end = self._place(context, entry)
        self.root.entry = self._process(network.top, context, end)

    def _place(self, context: _Context, where: Step | Declared, **fields: Any) -> int:
        context.thread.places.append(Place(where.span, context.path, **fields))
        return len(context.thread.places) - 1

    def _process(self, path: str, context: _Context, following: int) -> int:
        entry = self.classes[self.instances[path].class_name]
        assert isinstance(entry, ProcessClass)
        inner = replace(context, path=path)
        if entry.external is not None:
            return self._written_by_hand(path, entry, inner, following)
        if entry.body is None:
            return following
        starts = self._place(inner, entry, starts=path)
        context.thread.places[starts].successors = [self._begun(path, entry, inner, following)]
        return starts

    def _begun(self, path: str, entry: ProcessClass, context: _Context, following: int) -> int:
        inner = context
        assert entry.body is not None
        stated = entry.wcet
        if stated is None or context.stated is not None:
            return self._action(entry.body, inner, following)
        inner = replace(inner, stated=stated)
        began = self._place(inner, entry, cost=stated, leaf=path)
        context.thread.places[began].successors = [self._action(entry.body, inner, following)]
        return began

    def _written_by_hand(self, path: str, entry: ProcessClass, context: _Context, following: int) -> int:
        """It waits for any of its ports, computes, and waits again, until it ends."""
        cost = self._cost(path, entry, context)
        ports = [(port, k) for port in entry.ports for k in ((None,) if port.size is None else range(port.size))]
        ends = [(self.ends.net(path, PortEnd(port.name, k)), port.direction) for port, k in ports]
        move = Move(
            frozenset(net.path for net, direction in ends if net is not None and direction == "in"),
            frozenset(net.path for net, direction in ends if net is not None and direction == "out"),
        )
        outputs = tuple(net.path for net, _ in ends if net is not None and net.external == "out")
        gives = tuple(net.path for net, _ in ends if net is not None and never_waits(net))
        work = self._place(context, entry, cost=cost, leaf=path, outputs=outputs, gives=gives, move=move)
        waits = self._place(context, entry)
        place = context.thread.places[waits]
        for port, k in ports:
            end = PortEnd(port.name, k)
            if port.direction == "in":
                place.offers += self.ends.reading(path, end, work, entry)
            else:
                place.offers += self.ends.writing(path, end, work, entry)
        context.thread.places[work].successors = [waits, following] if place.offers else [following]
        self._interruptible(place, context)
        return waits if place.offers else work

    def _cost(self, path: str, entry: ProcessClass | SubmodelClass, context: _Context) -> int:
        if context.stated is not None:
            return 0
        stated = self.measured.get(path, entry.wcet)
        if stated is None:
            kind = "submodel" if isinstance(entry, SubmodelClass) else "process"
            self.missing.setdefault(path, Missing(path, entry.definition, kind, entry.span))  # type: ignore[arg-type]
            return 0
        return stated

    def _waiting(self, context: _Context, where: Step | Declared, offers: list[Offer], following: int) -> int:
        """A place that waits for one communication; ``following`` where it never waits."""
        if not offers:
            return following
        waits = self._place(context, where)
        place = context.thread.places[waits]
        place.offers = [
            replace(offer, target=self._resumed(context, where, offer.target), groups=context.groups)
            for offer in offers
        ]
        self._interruptible(place, context)
        return waits

    def _resumed(self, context: _Context, where: Step | Declared, target: int) -> int:
        """Within a process that states its time, every step takes that long."""
        if context.stated is None:
            return target
        resumed = self._place(context, where, cost=context.stated, leaf=context.path)
        context.thread.places[resumed].successors = [target]
        return resumed

    def _interruptible(self, place: Place, context: _Context) -> None:
        missed = [(offer, self._handler(context, "Timeout")) for offer in place.offers if offer.kind == "sample"]
        place.offers += [replace(offer, target=target) for offer, target in missed if target is not None]
        place.offers += context.interrupts

    def _handler(self, context: _Context, exception: str) -> int | None:
        return next((target for name, target in reversed(context.handlers) if name == exception), None)

    def _law(
        self,
        path: str,
        law: SubmodelClass,
        connections: tuple[Connection, ...],
        context: _Context,
        following: int,
        where: Action,
    ) -> int:
        inputs = {port.name for port in law.ports if port.direction == "in"}
        present = following
        for connection in reversed(connections):
            if connection.port not in inputs:
                offers = self.ends.writing(path, PortEnd(connection.port, connection.index), present, where)
                present = self._waiting(context, where, offers, present)
        names = [port.name for port in law.ports if port.direction == "out"]
        nets = [self.ends.net(path, PortEnd(c.port, c.index)) for c in connections if c.port in names]
        outputs = tuple(net.path for net in nets if net is not None and net.external == "out")
        gives = tuple(net.path for net in nets if net is not None and never_waits(net))
        work = self._place(
            context, law, cost=self._cost(path, law, context), leaf=path, outputs=outputs, gives=gives, move=self._move(path, connections, inputs)
        )  # fmt: skip
        fault = self._handler(context, "Fault")
        context.thread.places[work].successors = [present] if fault is None else [present, fault]
        present = work
        # The sample comes first: it is what begins the work of a period.
        reads: list[Offer] = []
        for connection in connections:
            attached = connection.attachment
            if connection.port in inputs and isinstance(attached, PortEnd | ChannelEnd):
                end = PortEnd(connection.port, connection.index, attached.end)
                reads += self.ends.reading(path, end, 0, where, owner=context.path)
        for offer in sorted(reads, key=lambda offer: ("partner", "event", "sample").index(offer.kind)):
            present = self._waiting(context, where, [replace(offer, target=present)], present)
        return present

    def _move(self, path: str, connections: Iterable[Connection], inputs: Collection[str]) -> Move:
        """What a law or a process written by hand computes from what."""
        nets = [(self.ends.net(path, PortEnd(c.port, c.index)), c.port in inputs) for c in connections]
        reads = frozenset(net.path for net, is_read in nets if net is not None and is_read)
        return Move(reads, frozenset(net.path for net, is_read in nets if net is not None and not is_read))

    def _action(self, action: Action, context: _Context, following: int) -> int:
        match action:
            case RunInstance():
                return self._run(action, context, following)
            case ReadValue():
                moved = self._copied(context, action, following)
                return self._waiting(
                    context, action, self.ends.reading(context.path, action.source, moved, action), moved
                )
            case WriteValue():
                return self._written(context, action, following)
            case WaitStep():
                return self._waiting(
                    context, action, self.ends.delay(context.path, action.duration, following, action.span), following
                )
            case AssignValue():
                target = frozenset([f"{context.path}.{action.target.channel}"])
                move = Move(_variables(context.path, action.value), target)
                return self._place(context, action, successors=[following], move=move)
            case SkipStep() | ResetInstance():
                return following
            case StopStep():
                stops = self._place(context, action)
                self._interruptible(context.thread.places[stops], context)
                return stops
            case RaiseException():
                handler = self._handler(context, action.exception)
                return self._place(context, action) if handler is None else handler
            case SequentialSteps():
                for step in reversed(action.steps):
                    following = self._action(step, context, following)
                return following
            case ParallelSteps():
                return self._parallel(action, context, following)
            case Choice():
                return self._choice(action, context, following)
            case Repeat() | WhileLoop():
                return self._loop(action, context, following)
            case IfElse():
                decides = self._place(context, action)
                sides = [self._action(side, context, following) for side in (action.then, action.otherwise)]
                context.thread.places[decides].successors = sides
                return decides
            case CatchException():
                handler = self._action(action.handler, context, following)
                inner = replace(context, handlers=(*context.handlers, (action.exception, handler)))
                return self._action(action.body, inner, following)
            case InterruptOn():
                offers = self._guard(action.branch, context, following)
                inner = replace(context, interrupts=(*context.interrupts, *offers))
                return self._action(action.body, inner, following)
            case Group():
                return self._action(action.body, context, following)
            case OptimizedStep():
                raise AssertionError("made by the optimizer, later")
            case _:
                assert_never(action)

    def _run(self, action: RunInstance, context: _Context, following: int) -> int:
        path = f"{context.path}.{action.instance}"
        entry = self.classes[self.instances[path].class_name]
        if isinstance(entry, ProcessClass):
            return self._process(path, context, following)
        owner = self.classes[self.instances[context.path].class_name]
        assert isinstance(owner, ProcessClass)
        declared = next(instance for instance in owner.instances if instance.name == action.instance)
        return self._law(path, entry, declared.connections, context, following, action)

    def _loop(self, action: Repeat | WhileLoop, context: _Context, following: int) -> int:
        again = self._place(context, action)
        body = self._action(action.body, context, again)
        if isinstance(action, WhileLoop):
            context.thread.places[again].successors = [body, following]
            return again
        context.thread.places[again].successors = [body] if action.until is None else [body, following]
        return body

    def _choice(self, action: Choice, context: _Context, following: int) -> int:
        offers = [offer for branch in action.branches for offer in self._guard(branch, context, following)]
        ready = [
            self._guarded(branch, context, following)
            for branch in action.branches
            if isinstance(branch.event, SkipEvent) or not self._guard_waits(branch, context)
        ]
        if not offers:
            return self._place(context, action, successors=ready or [following])
        waits = self._waiting(context, action, offers, following)
        if not ready:
            return waits
        return self._place(context, action, successors=[*ready, waits])

    def _guarded(self, branch: Branch, context: _Context, following: int) -> int:
        """What comes after a guard, with what the guard itself hands on."""
        body = self._action(branch.body, context, following)
        match branch.event:
            case InputEvent():
                return self._copied(context, branch.event, body)
            case OutputEvent():
                return self._handed_over(context, branch.event, body)
            case _:
                return body

    def _copied(self, context: _Context, action: ReadValue | InputEvent, following: int) -> int:
        """A value that was read into a variable."""
        net = self.ends.net(context.path, action.source)
        read = frozenset() if net is None else frozenset([net.path])
        move = Move(read, frozenset([f"{context.path}.{action.target.channel}"]))
        return self._place(context, action, successors=[following], move=move)

    def _handed_over(self, context: _Context, action: WriteValue | OutputEvent, following: int) -> int:
        """A value that goes to a channel or an output."""
        net = self.ends.net(context.path, action.sink)
        if net is None:
            return following
        move = Move(_variables(context.path, action.value), frozenset([net.path]))
        outputs = (net.path,) if net.external == "out" else ()
        gives = (net.path,) if never_waits(net) else ()
        return self._place(context, action, successors=[following], outputs=outputs, gives=gives, move=move)

    def _written(self, context: _Context, action: WriteValue, following: int) -> int:
        offers = self.ends.writing(context.path, action.sink, following, action)
        return self._handed_over(context, action, self._waiting(context, action, offers, following))

    def _guard_waits(self, branch: Branch, context: _Context) -> bool:
        return bool(self._offers(branch, context, 0))

    def _guard(self, branch: Branch, context: _Context, following: int) -> list[Offer]:
        if not self._offers(branch, context, 0):
            return []
        return self._offers(branch, context, self._guarded(branch, context, following))

    def _offers(self, branch: Branch, context: _Context, target: int) -> list[Offer]:
        event = branch.event
        match event:
            case ReadyEvent():
                return self.ends.reading(context.path, event.source, target, event, takes=False)
            case InputEvent():
                return self.ends.reading(context.path, event.source, target, event)
            case OutputEvent():
                return self.ends.writing(context.path, event.sink, target, event)
            case AfterEvent():
                return self.ends.delay(context.path, event.duration, target, event.span)
            case SkipEvent():
                return []
            case _:
                assert_never(event)

    def _parallel(self, action: ParallelSteps, context: _Context, following: int) -> int:
        ranks = [(*context.priority, k) if action.prioritized else context.priority for k in range(len(action.steps))]
        if not any(self._looping.has_loop(step, context.path) for step in action.steps):
            self._groups += 1
            inside = replace(context, groups=(*context.groups, self._groups))
            for step, rank in zip(reversed(action.steps), reversed(ranks), strict=True):
                switches = self._place(context, step, successors=[following], breaks=True)
                following = self._action(step, replace(inside, priority=rank), switches)
            return following
        started: list[Thread] = []
        for step, rank in zip(action.steps, ranks, strict=True):
            thread = Thread(self._named(step, context.path), rank)
            inner = _Context(thread, context.path, rank, stated=context.stated)
            thread.entry = self._action(step, inner, self._place(inner, step))
            started.append(thread)
        context.thread.forks.append(started)
        joins = self._place(context, action)
        context.thread.places[joins].offers = [Offer("join", following, action.span)]
        return joins

    def _named(self, step: Action, path: str) -> str:
        match step:
            case RunInstance():
                return f"{path}.{step.instance}"
            case Group():
                return f"{path}.{step.label}"
            case _:
                runs = [part for part in parts(step) if isinstance(part, RunInstance)]
                return f"{path}.{runs[0].instance}" if runs else path


def _variables(path: str, value: Expression) -> frozenset[str]:
    return frozenset(f"{path}.{part.channel}" for part in parts(value) if isinstance(part, VariableValue))
