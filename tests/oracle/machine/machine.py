"""The composition diagram as it runs: one thread at a time, until it must wait.

Follows the sections The composition diagram and Scheduling and traces of the page.
"""

from __future__ import annotations

from tests.oracle.machine.clock import MissedSampleError
from tests.oracle.machine.core import CANCEL, NEXT, MustWaitError
from tests.oracle.machine.guards import Guards
from tests.oracle.machine.laws import Laws, assign
from tests.oracle.machine.link import Node
from tests.oracle.machine.parallels import Parallels
from tests.oracle.machine.state import (  # fmt: skip
    CANCELLATION,
    Branches,
    Choice,
    Delay,
    Frame,
    Joint,
    Signal,
    State,
    Stopped,
    Thread,
    Tid,
)
from tests.oracle.machine.values import NOW, FaultError, evaluate, nanoseconds
from tests.oracle.programs.tree import (
    After,
    Alt,
    Assign,
    Catch,
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
    Wait,
    While,
    Write,
)  # fmt: skip


class Machine(Parallels, Guards, Laws):
    def start(self) -> State:
        program = self.linked.program
        root = Thread((), (), -1, (), ("exec", self.linked.root.id))
        st = State(
            now=0,
            threads={(): root},
            ready=[()],
            variables={NOW: 0, **{variable.name: variable.initial for variable in program.variables}},
            buffers={},
            laws={law.name: tuple(initial for _, _, initial, _ in law.states) for law in program.laws},
            chosen={},
            sessions={},
            samples={},
            offered={},
            events={},
            latches={},
        )
        self.clock.start(st)
        return st

    def candidates(self, st: State) -> list[Tid]:
        """The threads that may run: the ready ones with the highest priority, in the order in which they
        became ready.
        """
        if st.running is not None:
            return [st.running]
        if not st.ready:
            return []
        priority = {tid: st.threads[tid[:-1] if tid[-1:] == (CANCELLATION,) else tid].priority for tid in st.ready}
        best = min(priority.values())
        return [tid for tid in st.ready if priority[tid] == best]

    def more_follows(self, st: State) -> bool:
        """Whether anything that arrives by itself can wake a process, or a value has yet to be output."""
        if st.latches or self.clock.dues(st):
            return True
        return any(end in self.linked.ports for end in self.awaited(st))

    def awaited(self, st: State) -> set[str]:
        """The channels and ports that some process waits for."""
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
        """Run a thread until it waits, ends, or has completed one iteration of a loop (then it stays `running`)."""
        if tid[-1:] == (CANCELLATION,):
            st.ready.remove(tid)
            self._cancel(st, st.threads[tid[:-1]])
            return
        thread = st.threads[tid]
        if st.running is None:
            st.ready.remove(tid)
        st.running = tid
        signal = self._resumed(st, thread)
        try:
            while st.running == tid and signal is not None:
                before = len(self.clock.made)
                signal = self._step(st, thread, signal)
                if self.policy.fine and signal is not None and len(self.clock.made) > before:
                    thread.signal = signal
                    st.ready.append(tid)
                    break
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
                case ("retry",) if isinstance(thread.wait, Choice):
                    return self._choose(st, thread, thread.wait)
                case ("retry",):
                    return self._retry(st, thread)
                case ("cancel",):
                    self._end(st, thread, None, cancelled=True)
                    return None
                case ("abandoned",):
                    return self._abandoned(st, thread)
                case ("chosen", int(number), int(index), value):
                    thread.stack = thread.stack[:-1]
                    return self._chosen(st, self.linked.nodes[number], index, value)
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
                assign(st, target, evaluate(expr, st.variables))
                return NEXT
            case Read() | Write():
                return self._communicate(st, thread, node, "comm", node.comp)
            case Wait(time, until):
                length = nanoseconds(time, st.variables)
                if thread.cancel:
                    return CANCEL
                return self._delay(st, thread, length - st.now if until else length)
            case Stop():
                if thread.cancel:
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
                offers = [self._offer(st, index, guard) for index, guard in enumerate(node.inner)]
                return self._alternative(st, thread, node, tuple(offer for offer in offers if offer is not None))
            case Guarded(event, _, when):
                if when is None and not isinstance(event, Skip | Ready | After):
                    return self._communicate(st, thread, node, "guard", event)
                offer = self._offer(st, 0, node)
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
            case Interrupt():
                return self._interrupt(st, thread, node)
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
        thread.stack = thread.stack[:-1]
        return NEXT

    def _delay(self, st: State, thread: Thread, time: int) -> Signal:
        if time <= 0:
            return NEXT
        st.seq += 1
        thread.wait = Delay(st.now + time, st.seq)
        raise MustWaitError
