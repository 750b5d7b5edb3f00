"""The threads of a network."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache, partial
from typing import assert_never

from cspdiag.analyses.timing.threads.communicating import Communicating
from cspdiag.analyses.timing.threads.first_waits import FirstWaits
from cspdiag.analyses.timing.threads.graph import LoopRange, Move, Offer, Thread
from cspdiag.analyses.timing.threads.looping import Looping
from cspdiag.analyses.timing.threads.places import Context, variables_in
from cspdiag.analyses.timing.threads.termination import LARGEST_NUMBER_OF_ITERATIONS, Loop
from cspdiag.base.record import replaced
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.raised import NO_EXCEPTIONS, Exceptions, exceptions_of
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import CoreClass, CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts


class Threads(Communicating):
    """Makes the threads of a network; ``root`` is the outermost one."""

    def __init__(self, network: CoreNetwork, measured: Mapping[str, int]) -> None:
        super().__init__(network, measured)
        self._looping = Looping(network)
        self._first_waits = FirstWaits(
            self.channel_ends, {path: self.classes[instance.class_name] for path, instance in self.instances.items()}
        )
        self._runs: dict[str, Counter[str]] = {}
        self.root = Thread(network.top, (), is_outermost=True)
        entry = self.classes[self.instances[network.top].class_name]
        context = Context(self.root, network.top, (), runs_once=True)
        end = self.place(context, entry)
        self.root.entry = self._process(network.top, context, end)
        self._note_shared_inputs(list(self.root.with_forks()))

    @staticmethod
    def _note_shared_inputs(threads: Sequence[Thread]) -> None:
        """Note for each thread which inputs other threads read as well, and whether the program begins with it."""
        followed = [{(key[1], period) for key, period in thread.samples()} for thread in threads]
        counts = Counter(period for periods in followed for period in periods)
        for thread, periods in zip(threads, followed, strict=True):
            thread.shared = frozenset(period for period in periods if counts[period] > 1)
            thread.begins_at_once |= thread.is_outermost
            first = thread.first_waits()
            for join, group in zip(thread.joins, thread.forks, strict=True):
                for branch in group:
                    branch.begins_at_once = thread.begins_at_once and first == {join}

    def _process(self, path: str, context: Context, following: int) -> int:
        entry = self.classes[self.instances[path].class_name]
        assert isinstance(entry, ProcessClass)
        initial = cache(lambda: self.termination.initial(path, entry) if context.runs_once else {})
        inner = replaced(context, path=path, before=initial)
        if entry.external is not None:
            return self.written_by_hand(path, entry, inner, following)
        if entry.body is None:
            return following
        starts = self.place(inner, entry, starts=path)
        context.thread.places[starts].successors = [self._body(path, entry, inner, following)]
        return starts

    def _body(self, path: str, entry: CoreClass, context: Context, following: int) -> int:
        inner = context
        assert entry.body is not None
        stated = entry.wcet
        if stated is None or context.stated is not None:
            return self._action(entry.body, inner, following)
        inner = replaced(inner, stated=stated)
        began = self.place(inner, entry, cost=stated, leaf=path)
        context.thread.places[began].successors = [self._action(entry.body, inner, following)]
        return began

    def _action(self, action: ir.CoreAction, context: Context, following: int) -> int:
        match action:
            case ir.RunInstance():
                return self._run(action, context, following)
            case ir.ReadValue():
                moved = self.copied(context, action, following)
                return self.waiting(
                    context, action, self.channel_ends.reading(context.path, action.source, moved, action), moved
                )
            case ir.WriteValue():
                return self.written(context, action, following)
            case ir.WaitStep():
                return self.waiting(
                    context,
                    action,
                    self.channel_ends.delay(context.path, action.duration, following, action.span),
                    following,
                )
            case ir.AssignValue():
                target = frozenset([f"{context.path}.{action.target.channel}"])
                move = Move(variables_in(context.path, action.value), target)
                return self.place(context, action, successors=[following, *self.faults(context)], move=move)
            case ir.SkipStep() | ir.ResetInstance():
                return following
            case ir.StopStep():
                stops = self.place(context, action, halts=True)
                self.interruptible(context.thread.places[stops], context)
                return stops
            case ir.RaiseException():
                handler = self.handler(context, action.exception)
                return self.place(context, action, raises=True) if handler is None else handler
            case ir.SequentialSteps():
                found = cache(lambda: self.termination.before_each(context.path, action.steps, context.before()))
                for k, step in reversed(list(enumerate(action.steps))):
                    before = partial(lambda k: found()[k], k)
                    following = self._action(step, replaced(context, before=before), following)
                return following
            case ir.ParallelSteps():
                return self._parallel(action, context, following)
            case ir.Choice():
                return self._choice(action, context, following)
            case ir.Repeat() | ir.WhileLoop():
                return self._loop(action, context, following)
            case ir.CountedLoop():
                return self._counted_loop(action, context, following)
            case ir.IfElse():
                known = self.channel_ends.constant(context.path, action.condition)
                if isinstance(known, bool):
                    return self._action(action.then if known else action.otherwise, context, following)
                decides = self.place(context, action)
                sides = [self._action(side, context, following) for side in (action.then, action.otherwise)]
                context.thread.places[decides].successors = [*sides, *self.faults(context)]
                return decides
            case ir.CatchException():
                handler = self._action(action.handler, context.after_partial(action.body), following)
                inner = replaced(context, handlers=(*context.handlers, (action.exception, handler)))
                begun = self._action(action.body, inner, following)
                if action.exception != "Fault" or self._first_waits.begins_by_waiting(context.path, action.body):
                    return begun  # A fault after each of its waits is added there.
                return self.place(context, action, successors=[begun, handler])
            case ir.InterruptOn():
                if not self.may_hold(action.branch, context):
                    return self._action(action.body, context, following)
                outside = context.after_partial(action.body)
                offers = self._guard(action.branch, outside, following)
                if not offers:
                    # A guard that never waits abandons the body wherever that would wait first.
                    offers = [Offer("delay", self._guarded(action.branch, outside, following), action.span)]
                offers = [replaced(offer, is_certain=False) for offer in offers]
                inner = replaced(context, interrupts=(*context.interrupts, *offers))
                return self._action(action.body, inner, following)
            case ir.Group():
                return self._action(action.body, context, following)
            case _:
                assert_never(action)

    def _run(self, action: ir.RunInstance, context: Context, following: int) -> int:
        path = f"{context.path}.{action.instance}"
        entry = self.classes[self.instances[path].class_name]
        if isinstance(entry, ProcessClass):
            return self._process(path, self._context_of_run(action, context), following)
        owner = self.classes[self.instances[context.path].class_name]
        assert isinstance(owner, ProcessClass)
        declared = next(instance for instance in owner.instances if instance.name == action.instance)
        return self.law(path, entry, declared.connections, context, following, action)

    def _context_of_run(self, action: ir.RunInstance, context: Context) -> Context:
        """Where a process begins: with its initial values only if its owner runs it nowhere else."""
        owner = self.instances[context.path].class_name
        if owner not in self._runs:
            self._runs[owner] = Counter(
                part.instance for part in parts(self.classes[owner]) if isinstance(part, ir.RunInstance)
            )
        return context if self._runs[owner][action.instance] == 1 else replaced(context, runs_once=False)

    def _loop(
        self, action: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction], context: Context, following: int
    ) -> int:
        header = self.place(context, action)
        inner = replaced(context.after_partial(action.body), runs_once=False)
        body = self._action(action.body, inner, header)
        ends = cache(partial(self.termination.ends, Loop(context.path, action, context.before)))
        context.thread.loops.append(LoopRange(header, len(context.thread.places), ends))
        after = [body, *self.faults(context)]
        if isinstance(action, ir.WhileLoop):
            continues = self.channel_ends.constant(context.path, action.condition)
        else:
            continues = (
                True if action.until is None else _negated(self.channel_ends.constant(context.path, action.until))
            )
        if continues is False:
            after = [following]
        elif continues is not True:
            after.append(following)
        context.thread.places[header].successors = after
        return header if isinstance(action, ir.WhileLoop) else body

    def _counted_loop(self, action: ir.CountedLoop[ir.CoreAction], context: Context, following: int) -> int:
        """Iteration by iteration, so the work of all of them is known; very many as a loop that is known to end."""
        if action.iterations > LARGEST_NUMBER_OF_ITERATIONS:
            header = self.place(context, action)
            iteration = replaced(context.after_partial(action.body), runs_once=False)
            body = self._action(action.body, iteration, header)
            context.thread.loops.append(LoopRange(header, len(context.thread.places), lambda: True, action.iterations))
            context.thread.places[header].successors = [body, following]
            return body
        iterations = ir.SequentialSteps(span=action.span, steps=(action.body,) * action.iterations)
        return self._action(iterations, replaced(context, runs_once=False), following)

    def _choice(self, action: ir.Choice[ir.CoreAction], context: Context, following: int) -> int:
        branches = [branch for branch in action.branches if self.may_hold(branch, context)]
        offers = [offer for branch in branches for offer in self._guard(branch, context, following)]
        always = [branch for branch in branches if not self._guard_waits(branch, context)]
        ready = [self._guarded(branch, context, following) for branch in always]
        if not offers:
            return self.place(context, action, successors=ready or [following])
        waits = self.waiting(context, action, offers, following)
        if not ready:
            return waits
        if any(self.must_hold(branch, context) for branch in always):
            context.thread.places[waits].polls = True
            context.thread.places[waits].successors = ready
            return waits
        return self.place(context, action, successors=[*ready, waits])

    def _guarded(self, branch: ir.Branch[ir.CoreAction], context: Context, following: int) -> int:
        """What comes after a guard, including what the guard itself passes on."""
        body = self._action(branch.body, context.after_partial(branch.event), following)
        match branch.event:
            case ir.InputEvent():
                return self.copied(context, branch.event, body)
            case ir.OutputEvent():
                return self.handed_over(context, branch.event, body)
            case ir.ReadyEvent() | ir.AfterEvent() | ir.SkipEvent():
                return body
            case _:
                assert_never(branch.event)

    def _guard_waits(self, branch: ir.Branch[ir.CoreAction], context: Context) -> bool:
        return bool(self._offers(branch, context, 0))

    def _guard(self, branch: ir.Branch[ir.CoreAction], context: Context, following: int) -> list[Offer]:
        if not self._offers(branch, context, 0):
            return []
        offers = self._offers(branch, context, self._guarded(branch, context, following))
        certain = self.must_hold(branch, context)
        return [replaced(offer, is_certain=certain) for offer in offers]

    def _offers(self, branch: ir.Branch[ir.CoreAction], context: Context, target: int) -> list[Offer]:
        event = branch.event
        match event:
            case ir.ReadyEvent():
                return self.channel_ends.reading(context.path, event.source, target, event, takes=False)
            case ir.InputEvent():
                return self.channel_ends.reading(context.path, event.source, target, event)
            case ir.OutputEvent():
                return self.channel_ends.writing(context.path, event.sink, target, event)
            case ir.AfterEvent():
                return self.channel_ends.delay(context.path, event.duration, target, event.span)
            case ir.SkipEvent():
                return []
            case _:
                assert_never(event)

    def _parallel(self, action: ir.ParallelSteps[ir.CoreAction], context: Context, following: int) -> int:
        ranks = [(*context.priority, k) if action.prioritized else context.priority for k in range(len(action.steps))]
        if not any(self._looping.has_loop(step, context.path) for step in action.steps):
            known = len(context.thread.places)
            inner = self._abandoned_by_others(action, context)
            for step, rank in zip(reversed(action.steps), reversed(ranks), strict=True):
                switches = self.place(context, step, successors=[following], breaks=True)
                following = self._action(step, replaced(inner, priority=rank), switches)
            inside = [offer for place in context.thread.places[known:] for offer in place.offers]
            may_follow = frozenset((offer.key, offer.period) for offer in inside if offer.kind == "sample")
            return self.place(context, action, successors=[following], may_follow=may_follow)
        started: list[Thread] = []
        for step, rank in zip(action.steps, ranks, strict=True):
            thread = Thread(self._thread_name(step, context.path), rank)
            inner = Context(
                thread, context.path, rank, stated=context.stated, before=context.before, runs_once=context.runs_once
            )
            thread.entry = self._action(step, inner, self.place(inner, step))
            started.append(thread)
        context.thread.forks.append(started)
        joins = self.place(context, action)
        context.thread.joins.append(joins)
        # An exception in a branch ends the others, and is handled where it is caught.
        below = [thread for branch in started for thread in branch.with_forks()]
        # Processes that are abandoned no longer follow their inputs.
        may_follow = frozenset(end for thread in below for end in thread.samples() if end[0][1] == context.path)
        abandons = [Offer("join", handler, action.span) for _, handler in context.handlers]
        abandons = [replaced(offer, may_follow=may_follow) for offer in (*abandons, *context.interrupts)]
        context.thread.places[joins].offers = [Offer("join", following, action.span), *abandons]
        return joins

    def _abandoned_by_others(self, action: ir.ParallelSteps[ir.CoreAction], context: Context) -> Context:
        """The context of parallel parts, which come one after another here: an exception in one abandons the waits of
        the others at once.
        """
        raised = {"Fault", "Timeout", *self._raised_in(action, context.path)}
        handlers = [handler for name, handler in context.handlers if name in raised]
        abandons = [Offer("delay", handler, action.span, is_certain=False) for handler in handlers]
        return replaced(context, interrupts=(*context.interrupts, *abandons))

    def _raised_in(self, action: ir.CoreAction, path: str) -> frozenset[str]:
        """The declared exceptions that an action may let through."""

        def of_instance(name: str) -> Exceptions:
            entry = self.classes[self.instances[f"{path}.{name}"].class_name]
            body = entry.body if isinstance(entry, ProcessClass) else None
            return NO_EXCEPTIONS if body is None else self._raised_in(body, f"{path}.{name}")

        raised, _ = exceptions_of(flow_of(action), of_instance)
        assert raised is not None
        return raised

    def _thread_name(self, step: ir.CoreAction, path: str) -> str:
        match step:
            case ir.RunInstance():
                return f"{path}.{step.instance}"
            case ir.Group():
                return f"{path}.{step.label}"
            case _:  # Any other branch is named after its first instance.
                runs = [part for part in parts(step) if isinstance(part, ir.RunInstance)]
                return f"{path}.{runs[0].instance}" if runs else path


def _negated(value: Value | None) -> bool | None:
    return not value if isinstance(value, bool) else None
