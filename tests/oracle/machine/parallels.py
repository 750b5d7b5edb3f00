"""Branches: of a parallel, and the body of an interrupt, which is a branch in parallel with a guard. How they end and
are cancelled.
"""

from __future__ import annotations

from tests.oracle.machine.core import CANCEL, NEXT, MustWaitError
from tests.oracle.machine.guards import Guards
from tests.oracle.machine.link import Node
from tests.oracle.machine.state import (
    CANCELLATION,
    Branches,
    Choice,
    Delay,
    Frame,
    Joint,
    Offer,
    Signal,
    State,
    Thread,
)  # fmt: skip
from tests.oracle.programs.tree import Catch, Interrupt, Par


class Parallels(Guards):
    def _spawn(self, st: State, thread: Thread, node: Node) -> Signal:
        if thread.cancel:
            return CANCEL
        assert isinstance(node.comp, Par)
        for index in range(len(node.inner)):
            self._branch(st, thread, node, index, rank=index if node.comp.prioritized else 0)
        thread.wait = Branches(node.id, tuple(range(len(node.inner))), None, False)
        raise MustWaitError

    def _branch(self, st: State, thread: Thread, node: Node, index: int, rank: int) -> None:
        """Priorities are ranks compared as if zeros followed, so a branch without a rank has that of its parent."""
        tid = (*thread.tid, (node.id, index))
        above = [self.linked.nodes[number].comp for number, _ in thread.tid]
        levels = sum(isinstance(comp, Par) and comp.prioritized for comp in above)
        zeros = (0,) * (levels - len(thread.priority))
        priority = (*thread.priority, *zeros, rank) if rank else thread.priority
        branch = index if node is self.linked.root and isinstance(node.comp, Par) else thread.branch
        st.threads[tid] = Thread(tid, priority, branch, (), ("exec", node.inner[index].id))
        st.ready.append(tid)

    def _end(self, st: State, thread: Thread, failed: str | None, cancelled: bool) -> None:
        if thread.branch in self.linked.program.boxed and len(thread.tid) == 1:
            self.clock.close(st, thread)
        if not thread.tid:
            st.ended = failed or "terminated"
            st.threads.clear()
            st.ready.clear()
            st.running = None
            return
        del st.threads[thread.tid]
        st.ready = [tid for tid in st.ready if tid != (*thread.tid, CANCELLATION)]
        st.running = None
        number, index = thread.tid[-1]
        parent = st.threads[thread.tid[:-1]]
        waits = parent.wait
        assert isinstance(waits, Branches)
        left = tuple(branch for branch in waits.running if branch != index)
        waits = Branches(number, left, waits.failed or failed, waits.cancelled or cancelled)
        parent.wait = waits
        if failed is not None:
            for branch in left:
                self._cancel(st, st.threads[(*parent.tid, (number, branch))])
        if not left:
            parent.wait = None
            parent.signal = self._after_branches(parent, waits)
            self.channels.ready(st, parent)

    def _after_branches(self, parent: Thread, waits: Branches) -> Signal:
        interrupt = isinstance(self.linked.nodes[waits.node].comp, Interrupt)
        if waits.failed is not None:
            parent.stack = parent.stack[:-1] if interrupt else parent.stack
            return ("raise", waits.failed)
        if not interrupt:
            return CANCEL if waits.cancelled and parent.cancel else NEXT
        frame = parent.stack[-1]
        if frame.status == "chosen" or (frame.status == "fired" and waits.cancelled):
            return ("abandoned",)
        parent.stack = parent.stack[:-1]
        return CANCEL if waits.cancelled else NEXT

    # ---- exceptions and cancellation ----

    def _raise(self, st: State, thread: Thread, name: str) -> Signal | None:
        while thread.stack:
            frame = thread.stack[-1]
            thread.stack = thread.stack[:-1]
            comp = self.linked.nodes[frame.node].comp
            if frame.kind == "catch" and isinstance(comp, Catch) and comp.name == name:
                return ("exec", self.linked.nodes[frame.node].inner[1].id)
        self._end(st, thread, name, cancelled=False)
        return None

    def _cancel(self, st: State, thread: Thread) -> None:
        """A thread is to end at its next place; one that waits is withdrawn at once.

        The thread that runs may be about to wait: it is withdrawn from there when its cancellation runs.
        """
        thread.cancel = True
        if st.running == thread.tid:
            turn = (*thread.tid, CANCELLATION)
            st.ready += [] if turn in st.ready else [turn]
            return
        match thread.wait:
            case None:
                pass
            case Branches(node, running, _, _):
                if thread.stack and thread.stack[-1].kind == "intr" and thread.stack[-1].status != "chosen":
                    thread.stack = (*thread.stack[:-1], thread.stack[-1]._replace(offer=None, status="off"))
                for branch in running:
                    self._cancel(st, st.threads[(*thread.tid, (node, branch))])
            case Joint(ops) if ops and all(op.done for op in ops):
                pass
            case Delay() if thread.tid in st.ready:
                pass
            case _:
                thread.wait = None
                thread.signal = CANCEL
                self.channels.ready(st, thread)

    # ---- interrupts ----

    def _interrupt(self, st: State, thread: Thread, node: Node) -> Signal:
        if thread.cancel:
            return CANCEL
        offer = self._offer(st, 0, node.inner[1])
        if offer is None:
            return ("exec", node.inner[0].id)
        self._branch(st, thread, node, 0, rank=0)
        thread.stack += (Frame("intr", node.id, 0, offer, "armed"),)
        self.channels.listens(st, offer)
        thread.wait = Branches(node.id, (0,), None, False)
        if self._is_ready(st, thread, offer):
            self.fire(st, thread, len(thread.stack) - 1)
        elif self._sampled(offer):
            self.clock.follow(st, thread, offer.channel, offer.session)
        raise MustWaitError

    def fire(self, st: State, thread: Thread, depth: int) -> None:
        """The guard of an interrupt has become ready: the body is cancelled, and nothing is communicated yet."""
        frame = thread.stack[depth]
        thread.stack = (*thread.stack[:depth], frame._replace(status="fired"), *thread.stack[depth + 1 :])
        if isinstance(thread.wait, Branches):
            for branch in thread.wait.running:
                self._cancel(st, st.threads[(*thread.tid, (frame.node, branch))])

    def _abandoned(self, st: State, thread: Thread) -> Signal:
        """The body was ended by the cancellation: the process is an alternative with the guard alone, unless the guard
        was chosen.
        """
        frame = thread.stack[-1]
        thread.stack = thread.stack[:-1]
        node = self.linked.nodes[frame.node]
        if frame.status == "chosen":
            return self._chosen(st, node, 0, frame.value)
        assert frame.offer is not None
        st.seq += 1
        offer: Offer = frame.offer._replace(seq=st.seq)
        if thread.cancel:
            return CANCEL
        thread.stack += (Frame("alt", node.id),)
        thread.wait = Choice(node.id, (offer,))
        return ("retry",)
