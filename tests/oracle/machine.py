"""The composition diagram as it runs: one thread at a time, until it must wait.

Follows the sections The composition diagram and Scheduling and traces of the page.
"""

from __future__ import annotations

from collections.abc import Sequence

from tests.oracle.channels import Channels
from tests.oracle.clock import Clock, MissedSampleError
from tests.oracle.link import Linked, Node
from tests.oracle.policy import Policy
from tests.oracle.state import (
    Branches,
    Choice,
    Delay,
    Frame,
    Joint,
    Offer,
    Op,
    Signal,
    State,
    Stopped,
    Thread,
    Tid,
)  # fmt: skip
from tests.oracle.tree import (
    After,
    Alt,
    Assign,
    Catch,
    Event,
    Guarded,
    If,
    Interrupt,
    Mu,
    Par,
    Raise,
    Read,
    Ready,
    Reset,
    Run,
    Seq,
    Skip,
    Stop,
    Target,
    Value,
    Wait,
    While,
    Write,
)  # fmt: skip
from tests.oracle.values import FaultError, evaluate

NEXT: Signal = ("next",)
CANCEL: Signal = ("cancel",)


class MustWaitError(Exception):
    """The thread that runs has to wait."""


class Machine:
    def __init__(self, linked: Linked, policy: Policy) -> None:
        self.linked = linked
        self.policy = policy
        self.channels = Channels(linked, policy, self.fire)
        self.clock = Clock(linked, policy, self.channels)
        self.written = self.clock.written

    def start(self) -> State:
        program = self.linked.program
        root = Thread((), (), -1, (), ("exec", self.linked.root.id))
        st = State(
            now=0,
            threads={(): root},
            ready=[()],
            variables={variable.name: variable.initial for variable in program.variables},
            buffers={},
            laws={law.name: tuple(initial for _, _, initial, _ in law.states) for law in program.laws},
            chosen={},
            books={},
            samples={},
            offered={},
            events={},
            latches={},
        )
        self.clock.start(st)
        return st

    def candidates(self, st: State) -> list[Tid]:
        """Who may run: the most urgent of the ready ones, in the order in which they became ready."""
        if st.running is not None:
            return [st.running]
        if not st.ready:
            return []
        best = min(st.threads[tid].priority for tid in st.ready)
        return [tid for tid in st.ready if st.threads[tid].priority == best]

    def awaited(self, st: State) -> set[str]:
        """The channels and ports that somebody waits for."""
        found: set[str] = set()
        for thread in st.threads.values():
            match thread.wait:
                case Joint(ops):
                    found |= {op.channel for op in ops if not op.done}
                case Choice(_, offers):
                    found |= {offer.channel for offer in offers}
            found |= {frame.offer.channel for frame in thread.stack if frame.offer is not None}
        return found

    def run(self, st: State, tid: Tid) -> None:
        """Runs a thread until it waits, ends, or has gone once around a loop (then it stays `running`)."""
        thread = st.threads[tid]
        if st.running is None:
            st.ready.remove(tid)
        st.running = tid
        signal = self._resumed(st, thread)
        try:
            while st.running == tid and signal is not None:
                signal = self._step(st, thread, signal)
                if signal is not None and signal[0] == "around":
                    thread.signal = ("exec", signal[1])
                    return
        except MustWaitError:
            pass
        st.running = None

    # ---- signals ----

    def _resumed(self, st: State, thread: Thread) -> Signal | None:
        match thread.wait:
            case None:
                return thread.signal
            case Delay() | Branches() | Stopped():
                thread.wait = None
                return NEXT
            case _:
                return ("retry",)

    def _step(self, st: State, thread: Thread, signal: Signal) -> Signal | None:
        try:
            match signal:
                case ("exec", int(number)):
                    return self._exec(st, thread, self.linked.nodes[number])
                case ("next",):
                    return self._next(st, thread)
                case ("retry",):
                    return self._retry(st, thread)
                case ("cancel",):
                    return self._unwind(st, thread)
                case ("chosen", int(number), int(index), value):
                    thread.stack = thread.stack[:-1]
                    return self._chosen(st, thread, self.linked.nodes[number], index, value)
                case ("raise", str(name)):
                    return self._raise(st, thread, name)
        except FaultError:
            return ("raise", "Fault")
        except MissedSampleError:
            thread.wait = None
            return ("raise", "Timeout")
        raise AssertionError(signal)

    def _exec(self, st: State, thread: Thread, node: Node) -> Signal:
        match node.comp:
            case Skip():
                return NEXT
            case Assign(target, expr):
                self._assign(st, target, evaluate(expr, st.variables))
                return NEXT
            case Read() | Write():
                return self._communicate(st, thread, node, "comm", node.comp)
            case Wait(time):
                if thread.cancel is not None:
                    return CANCEL
                return self._delay(st, thread, time)
            case Stop():
                if thread.cancel is not None:
                    return CANCEL
                thread.wait = Stopped()
                raise MustWaitError
            case Raise(name):
                return ("raise", name)
            case Reset(law):
                st.laws[law] = tuple(initial for _, _, initial, _ in self.linked.laws[law].states)
                return NEXT
            case Run(law):
                inputs = [
                    (source, None) for _, _, source in self.linked.laws[law].inputs if source in self.linked.ports
                ]
                return self._joint(st, thread, Frame("law-in", node.id), "?", inputs)
            case Seq():
                thread.stack += (Frame("seq", node.id, 1),)
                return ("exec", node.inner[0].id)
            case Par():
                return self._spawn(st, thread, node)
            case Alt():
                offers = [self._offer(st, index, guard) for index, guard in enumerate(node.comp.branches)]
                return self._alternative(st, thread, node, tuple(offer for offer in offers if offer is not None))
            case Guarded(event, _, when):
                if when is None and not isinstance(event, Skip | Ready | After):
                    return self._communicate(st, thread, node, "guard", event)
                offer = self._offer(st, 0, node.comp)
                return self._alternative(st, thread, node, () if offer is None else (offer,))
            case Mu():
                thread.stack += (Frame("mu", node.id),)
                return ("exec", node.inner[0].id)
            case While(condition):
                if evaluate(condition, st.variables):
                    thread.stack += (Frame("while", node.id),)
                    return ("exec", node.inner[0].id)
                return NEXT
            case If(condition):
                if evaluate(condition, st.variables):
                    return ("exec", node.inner[0].id)
                return ("exec", node.inner[1].id) if len(node.inner) > 1 else NEXT
            case Catch():
                thread.stack += (Frame("catch", node.id),)
                return ("exec", node.inner[0].id)
            case Interrupt(_, guard):
                if thread.cancel is not None:
                    return CANCEL
                return self._interrupt(st, thread, node, guard)
            case _:
                raise AssertionError(node.comp)

    def _next(self, st: State, thread: Thread) -> Signal | None:
        if not thread.stack:
            self._end(st, thread, None, cancelled=False)
            return None
        frame = thread.stack[-1]
        node = self.linked.nodes[frame.node]
        match frame.kind:
            case "seq" if frame.at < len(node.inner):
                thread.stack = (*thread.stack[:-1], frame._replace(at=frame.at + 1))
                return ("exec", node.inner[frame.at].id)
            case "mu":
                assert isinstance(node.comp, Mu)
                if node.comp.until is None or not evaluate(node.comp.until, st.variables):
                    return ("around", node.inner[0].id)
            case "while":
                assert isinstance(node.comp, While)
                if evaluate(node.comp.condition, st.variables):
                    return ("around", node.inner[0].id)
            case "intr":
                return self._body_ended(thread, frame)
        thread.stack = thread.stack[:-1]
        return NEXT

    def _end(self, st: State, thread: Thread, failed: str | None, cancelled: bool) -> None:
        for key in [key for key in st.books if key[0] == thread.tid]:
            del st.books[key]
        if not thread.tid:
            st.ended = failed or "terminated"
            st.threads.clear()
            st.ready.clear()
            st.running = None
            return
        del st.threads[thread.tid]
        st.running = None
        number, index = thread.tid[-1]
        parent = st.threads[thread.tid[:-1]]
        waits = parent.wait
        assert isinstance(waits, Branches)
        assert waits.node == number
        left = tuple(branch for branch in waits.running if branch != index)
        parent.wait = Branches(number, left, waits.failed or failed, waits.cancelled or cancelled)
        if failed is not None:
            for branch in left:
                self._cancel(st, st.threads[(*parent.tid, (number, branch))], 0)
        if not left:
            if parent.wait.failed is not None:
                parent.signal = ("raise", parent.wait.failed)
            else:
                parent.signal = CANCEL if parent.wait.cancelled and parent.cancel is not None else NEXT
            parent.wait = None
            self.channels.ready(st, parent)

    def _spawn(self, st: State, thread: Thread, node: Node) -> Signal:
        if thread.cancel is not None:
            return CANCEL
        assert isinstance(node.comp, Par)
        for index, inner in enumerate(node.inner):
            tid = (*thread.tid, (node.id, index))
            priority = (*thread.priority, index) if node.comp.prioritized else thread.priority
            branch = index if node is self.linked.root else thread.branch
            st.threads[tid] = Thread(tid, priority, branch, (), ("exec", inner.id))
            st.ready.append(tid)
        thread.wait = Branches(node.id, tuple(range(len(node.inner))), None, False)
        raise MustWaitError

    # ---- exceptions and interrupts ----

    def _raise(self, st: State, thread: Thread, name: str) -> Signal | None:
        while thread.stack:
            frame = thread.stack[-1]
            thread.stack = thread.stack[:-1]
            self._forget(thread)
            comp = self.linked.nodes[frame.node].comp
            if frame.kind == "catch" and isinstance(comp, Catch) and comp.name == name:
                return ("exec", self.linked.nodes[frame.node].inner[1].id)
        self._end(st, thread, name, cancelled=False)
        return None

    def _forget(self, thread: Thread) -> None:
        """A request to abandon frames that are gone is no longer of matter."""
        if thread.cancel is not None and thread.cancel > len(thread.stack):
            thread.cancel = None

    def _cancel(self, st: State, thread: Thread, depth: int) -> None:
        """A thread is to be abandoned down to a depth of its stack, at its next communication."""
        thread.cancel = depth if thread.cancel is None else min(depth, thread.cancel)
        match thread.wait:
            case None:
                pass
            case Branches(node, running, _, _):
                for branch in running:
                    self._cancel(st, st.threads[(*thread.tid, (node, branch))], 0)
            case Joint(ops) if ops and all(op.done for op in ops):
                pass
            case Delay() if thread.tid in st.ready:
                pass
            case _:
                thread.wait = None
                thread.signal = CANCEL
                self.channels.ready(st, thread)

    def _unwind(self, st: State, thread: Thread) -> Signal | None:
        depth = thread.cancel
        assert depth is not None
        thread.stack = thread.stack[:depth]
        if depth == 0:
            self._end(st, thread, None, cancelled=True)
            return None
        thread.cancel = None
        frame = thread.stack[-1]
        thread.stack = thread.stack[:-1]
        node = self.linked.nodes[frame.node]
        assert isinstance(node.comp, Interrupt)
        if frame.status == "chosen":
            return self._handle(st, thread, node, frame.value)
        offer = frame.offer
        assert offer is not None
        if offer.kind in ("after", "skip"):
            return ("exec", node.inner[1].inner[0].id)
        end = "?" if offer.kind == "read" else "!"
        return self._joint(st, thread, Frame("handler", node.id), end, [(offer.channel, offer.value)])

    def _handle(self, st: State, thread: Thread, node: Node, value: Value | None) -> Signal:
        guard = node.inner[1]
        assert isinstance(guard.comp, Guarded)
        if isinstance(guard.comp.event, Read):
            assert value is not None
            self._assign(st, guard.comp.event.target, value)
        return ("exec", guard.inner[0].id)

    def _interrupt(self, st: State, thread: Thread, node: Node, guard: Guarded) -> Signal:
        offer = self._offer(st, 0, guard)
        thread.stack += (Frame("intr", node.id, 0, offer, "off" if offer is None else "armed"),)
        if offer is not None and self._is_ready(st, thread, offer):
            self.fire(st, thread, len(thread.stack) - 1)
        return ("exec", node.inner[0].id)

    def fire(self, st: State, thread: Thread, depth: int) -> None:
        """The guard of an interrupt has become ready."""
        frame = thread.stack[depth]
        thread.stack = (*thread.stack[:depth], frame._replace(status="fired"), *thread.stack[depth + 1 :])
        self._cancel(st, thread, depth + 1)

    def _body_ended(self, thread: Thread, frame: Frame) -> Signal:
        thread.stack = thread.stack[:-1]
        self._forget(thread)
        if frame.status == "chosen":
            node = self.linked.nodes[frame.node]
            thread.stack += (Frame("chosen", frame.node, 0, None, "", frame.value),)
            return ("chosen", node.id, -1, frame.value)
        return NEXT

    # ---- alternatives ----

    def _offer(self, st: State, index: int, guard: Guarded) -> Offer | None:
        """The guard as its alternative begins, if its condition holds."""
        if guard.when is not None and not evaluate(guard.when, st.variables):
            return None
        st.seq += 1
        match guard.event:
            case Read(channel, _):
                return Offer(index, "read", channel, None, 0, st.seq)
            case Write(channel, value):
                return Offer(index, "write", channel, evaluate(value, st.variables), 0, st.seq)
            case After(time):
                return Offer(index, "after", "", None, st.now + time, st.seq)
            case Ready(channel):
                return Offer(index, "ready", channel, None, 0, st.seq)
            case _:
                return Offer(index, "skip", "", None, 0, st.seq)

    def _alternative(self, st: State, thread: Thread, node: Node, offers: tuple[Offer, ...]) -> Signal:
        if thread.cancel is not None:
            return CANCEL
        thread.stack += (Frame("alt", node.id),)
        for offer in offers:
            if self._sampled(offer):
                self.clock.follow(st, thread, offer.channel)
        thread.wait = Choice(node.id, offers)
        return ("retry",)

    def _sampled(self, offer: Offer) -> bool:
        port = self.linked.ports.get(offer.channel)
        return port is not None and port.input and port.period is not None

    def _is_ready(self, st: State, thread: Thread, offer: Offer) -> bool:
        match offer.kind:
            case "skip":
                return True
            case "after":
                return st.now >= offer.due
            case "write" if offer.channel in self.linked.ports:
                return True
            case _ if offer.channel in self.linked.ports:
                return self.clock.available(st, thread, offer.channel)
            case _:
                return self.channels.possible(st, offer, thread)

    def _choose(self, st: State, thread: Thread, choice: Choice) -> Signal:
        ready = [offer for offer in choice.offers if self._is_ready(st, thread, offer)]
        if not ready:
            raise MustWaitError
        node = self.linked.nodes[choice.node]
        offer = ready[0]
        if isinstance(node.comp, Alt) and not node.comp.prioritized and len(ready) > 1:
            if self.policy.free:
                offer = ready[self.policy.choose(len(ready))]
            else:
                last = st.chosen.get(node.id, -1)
                offer = next((each for each in ready if each.place > last), ready[0])
        st.chosen[node.id] = offer.place
        thread.wait = None
        value: Value | None = None
        if offer.kind in ("read", "write"):
            value = self._take(st, thread, offer)
        return ("chosen", node.id, offer.place, value)

    def _take(self, st: State, thread: Thread, offer: Offer) -> Value | None:
        if offer.channel not in self.linked.ports:
            return self.channels.take(st, offer, thread)
        if offer.kind == "read":
            return self.clock.read(st, thread, offer.channel)
        assert offer.value is not None
        self.clock.write(st, offer.channel, offer.value)
        return None

    def _chosen(self, st: State, thread: Thread, node: Node, index: int, value: Value | None) -> Signal:
        if index < 0:
            return self._handle(st, thread, node, value)
        guard = node.inner[index] if isinstance(node.comp, Alt) else node
        st.chosen[node.id] = index
        assert isinstance(guard.comp, Guarded)
        if isinstance(guard.comp.event, Read):
            assert value is not None
            self._assign(st, guard.comp.event.target, value)
        return ("exec", guard.inner[0].id)

    # ---- communications and laws ----

    def _communicate(self, st: State, thread: Thread, node: Node, kind: str, event: Event) -> Signal:
        if isinstance(event, Read):
            return self._joint(st, thread, Frame(kind, node.id), "?", [(event.channel, None)])
        assert isinstance(event, Write)
        value = evaluate(event.value, st.variables)
        return self._joint(st, thread, Frame(kind, node.id), "!", [(event.channel, value)])

    def _joint(
        self, st: State, thread: Thread, frame: Frame, end: str, wanted: Sequence[tuple[str, Value | None]]
    ) -> Signal:
        """Communications that are wanted together; what is there is taken in their order."""
        if wanted and thread.cancel is not None:
            return CANCEL
        thread.stack += (frame,)
        ops: list[Op] = []
        for channel, value in wanted:
            st.seq += 1
            op = Op(channel, end, value, st.seq)
            if channel not in self.linked.ports:
                op = self.channels.attempt(st, op, thread)
            elif end == "?" and self.linked.ports[channel].period is not None:
                self.clock.follow(st, thread, channel)
            ops.append(op)
        thread.wait = Joint(tuple(ops))
        return ("retry",)

    def _retry(self, st: State, thread: Thread) -> Signal:
        """What waits looks again: at external ports, and at the guards of alternatives."""
        if isinstance(thread.wait, Choice):
            return self._choose(st, thread, thread.wait)
        assert isinstance(thread.wait, Joint)
        ops = list(thread.wait.ops)
        for index, op in enumerate(ops):
            if op.done or op.channel not in self.linked.ports:
                continue
            if op.end == "!":
                assert op.value is not None
                self.clock.write(st, op.channel, op.value)
                ops[index] = op._replace(done=True)
            elif self.clock.available(st, thread, op.channel):
                ops[index] = op._replace(done=True, value=self.clock.read(st, thread, op.channel))
        thread.wait = Joint(tuple(ops))
        if not all(op.done for op in ops):
            raise MustWaitError
        thread.wait = None
        return self._made(st, thread, ops)

    def _made(self, st: State, thread: Thread, ops: list[Op]) -> Signal:
        frame = thread.stack[-1]
        thread.stack = thread.stack[:-1]
        node = self.linked.nodes[frame.node]
        match frame.kind, node.comp:
            case "comm", Read(_, target):
                assert ops[0].value is not None
                self._assign(st, target, ops[0].value)
            case "guard", Guarded(event, _, _):
                if isinstance(event, Read):
                    assert ops[0].value is not None
                    self._assign(st, event.target, ops[0].value)
                return ("exec", node.inner[0].id)
            case "handler", _:
                return self._handle(st, thread, node, ops[0].value)
            case "law-in", Run(law):
                return self._compute(st, thread, node, law, ops)
        return NEXT

    def _compute(self, st: State, thread: Thread, node: Node, name: str, ops: list[Op]) -> Signal:
        law = self.linked.laws[name]
        read = {op.channel: op.value for op in ops}
        names: dict[str, Value] = {}
        for inner, _, source in law.inputs:
            value = read.get(source, st.variables.get(source))
            assert value is not None
            names[inner] = value
        names.update(zip((state for state, _, _, _ in law.states), st.laws[name], strict=True))
        outputs = [(sink, evaluate(expr, names)) for _, _, sink, expr in law.outputs]
        st.laws[name] = tuple(evaluate(following, names) for _, _, _, following in law.states)
        self.clock.elapse(st, self.policy.compute(law))
        written: list[tuple[str, Value | None]] = []
        for sink, value in outputs:
            if sink in self.linked.ports:
                written.append((sink, value))
            elif sink != "_":
                st.variables[sink] = value
        return self._joint(st, thread, Frame("law-out", node.id), "!", written)

    def _delay(self, st: State, thread: Thread, time: int) -> Signal:
        if time <= 0:
            return NEXT
        st.seq += 1
        thread.wait = Delay(st.now + time, st.seq)
        raise MustWaitError

    def _assign(self, st: State, target: Target, value: Value) -> None:
        if target.at is not None:
            whole = st.variables[target.name]
            assert isinstance(whole, tuple)
            value = (*whole[: target.at], value, *whole[target.at + 1 :])
        st.variables[target.name] = value
