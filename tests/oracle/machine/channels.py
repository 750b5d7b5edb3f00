"""Communications: which parties meet on a channel, by kind.

Parties that merely read or write (`Joint`) are served in the order in which they arrived, and before alternatives and
interrupts; they never decide for an alternative, which they only wake. There are no queues: the waiting parties are
found among the threads, in the order of `seq`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tests.oracle.machine.link import Linked
from tests.oracle.machine.policy import Policy
from tests.oracle.machine.state import Choice, Frame, Joint, Offer, Op, State, Thread
from tests.oracle.programs.tree import Interrupt, Value

KIND = {"?": "read", "!": "write"}
OTHER = {"?": "!", "!": "?"}

Fire = Callable[[State, Thread, int], None]


class Channels:
    """Operations on channels and external ports."""

    def __init__(self, linked: Linked, policy: Policy, fire: Fire) -> None:
        self.linked = linked
        self.policy = policy
        self.fire = fire

    # ---- waiting parties ----

    def plain(self, st: State, channel: str, end: str) -> list[tuple[Op, Thread]]:
        found = []
        for thread in st.threads.values():
            if isinstance(thread.wait, Joint):
                found += [
                    (op, thread) for op in thread.wait.ops if (op.channel, op.end, op.done) == (channel, end, False)
                ]
        return sorted(found, key=lambda each: each[0].seq)

    def offers(self, st: State, channel: str, end: str) -> Iterator[tuple[Offer, Thread, int | None]]:
        """Guards that wait: of alternatives, and of interrupts, which come with the place of their frame."""
        kind = KIND[end]
        for thread in st.threads.values():
            if isinstance(thread.wait, Choice):
                for offer in thread.wait.offers:
                    if offer.kind == kind and offer.channel == channel:
                        yield offer, thread, None
            for depth, frame in enumerate(thread.stack):
                if frame.offer is None or frame.status not in ("armed", "fired"):
                    continue
                if frame.offer.kind == kind and frame.offer.channel == channel:
                    yield frame.offer, thread, depth

    def wake(self, st: State, channel: str, end: str, only: int | None = None) -> None:
        """Let alternatives check their guards, in the order of the program, and then interrupts by their age."""
        found = list(self.offers(st, channel, end))
        boxed = self.linked.program.boxed
        choices = {thread.tid: thread for _, thread, depth in found if depth is None and not self._interrupts(thread)}
        for thread in sorted(choices.values(), key=lambda each: (each.branch not in boxed, each.tid)):
            if only is None or thread.branch == only:
                self.ready(st, thread)
        guards = [(offer.seq, thread, depth) for offer, thread, depth in found if thread.tid not in choices]
        for _, thread, depth in sorted(guards, key=lambda each: each[0]):
            if only is not None and thread.branch != only:
                continue
            if depth is None:
                self.ready(st, thread)
            elif thread.stack[depth].status == "armed":
                self.fire(st, thread, depth)

    def _interrupts(self, thread: Thread) -> bool:
        """Whether the guard with which a thread waits is that of an interrupt whose body has ended."""
        return isinstance(thread.wait, Choice) and isinstance(self.linked.nodes[thread.wait.node].comp, Interrupt)

    def ready(self, st: State, thread: Thread) -> None:
        if thread.tid not in st.ready and st.running != thread.tid:
            st.ready.append(thread.tid)

    def complete(self, st: State, thread: Thread, old: Op, value: Value | None) -> None:
        """One communication of a waiting thread is complete; with the last one it becomes ready."""
        assert isinstance(thread.wait, Joint)
        ops = tuple(op._replace(done=True, value=value, pending=()) if op is old else op for op in thread.wait.ops)
        thread.wait = Joint(ops)
        if all(op.done for op in ops):
            self.ready(st, thread)

    # ---- plain readers and writers ----

    def attempt(self, st: State, op: Op, me: Thread) -> Op:
        """The communication complete, or the same one waiting; the parties that it may concern are woken."""
        channel = self.linked.channels.get(op.channel)
        assert channel is not None
        match channel.kind:
            case "buffer" | "overwrite":
                return (
                    self._put(st, op, channel.size, channel.kind == "overwrite") if op.end == "!" else self._get(st, op)
                )
            case "broadcast":
                return self._broadcast(st, op) if op.end == "!" else self._receive(st, op, me.branch)
            case _:
                return self._meet(st, op)

    def _meet(self, st: State, op: Op) -> Op:
        others = self.plain(st, op.channel, OTHER[op.end])
        if not others:
            self.wake(st, op.channel, OTHER[op.end])
            return op
        other, thread = others[0]
        value = op.value if op.end == "!" else other.value
        assert value is not None
        self.policy.passed(op.channel, value, external=False)
        self.complete(st, thread, other, value)
        return op._replace(done=True, value=value)

    def _put(self, st: State, op: Op, size: int, overwrite: bool) -> Op:
        assert op.value is not None
        readers = self.plain(st, op.channel, "?")
        held = st.buffers.get(op.channel, ())
        if not readers and not overwrite and len(held) >= size:
            return op
        self.policy.passed(op.channel, op.value, external=False)
        if readers:
            self.complete(st, readers[0][1], readers[0][0], op.value)
        else:
            st.buffers[op.channel] = (*held, op.value)[-size:]
            self.wake(st, op.channel, "?")
        return op._replace(done=True)

    def _get(self, st: State, op: Op) -> Op:
        held = st.buffers.get(op.channel, ())
        if not held:
            return op
        st.buffers[op.channel] = held[1:]
        writers = self.plain(st, op.channel, "!")
        if writers:
            other, thread = writers[0]
            assert other.value is not None
            self.policy.passed(op.channel, other.value, external=False)
            st.buffers[op.channel] = (*held[1:], other.value)
            self.complete(st, thread, other, other.value)
        else:
            self.wake(st, op.channel, "!")
        return op._replace(done=True, value=held[0])

    def _broadcast(self, st: State, op: Op) -> Op:
        """Give the value to each end at which a reader waits; the writer continues when all ends have it."""
        assert op.value is not None
        pending: list[int] = []
        readers = {thread.branch: (other, thread) for other, thread in self.plain(st, op.channel, "?")}
        for end in self.linked.ends[op.channel]:
            if end in readers:
                other, thread = readers[end]
                self.policy.passed(op.channel, op.value, external=False)
                self.complete(st, thread, other, op.value)
            else:
                pending.append(end)
                self.wake(st, op.channel, "?", only=end)
        return op._replace(pending=tuple(pending), done=not pending)

    def _receive(self, st: State, op: Op, branch: int) -> Op:
        for other, thread in self.plain(st, op.channel, "!"):
            if branch in other.pending:
                assert other.value is not None
                assert isinstance(thread.wait, Joint)
                self.policy.passed(op.channel, other.value, external=False)
                left = tuple(end for end in other.pending if end != branch)
                if left:
                    thread.wait = Joint(tuple(o._replace(pending=left) if o is other else o for o in thread.wait.ops))
                else:
                    self.complete(st, thread, other, other.value)
                return op._replace(done=True, value=other.value)
        self.wake(st, op.channel, "!")
        return op

    # ---- guards ----

    def possible(self, st: State, offer: Offer, me: Thread) -> bool:
        """Whether a guard on a channel is ready."""
        channel = self.linked.channels[offer.channel]
        end = "?" if offer.kind == "read" else "!"
        match channel.kind, end:
            case ("overwrite", "!"):
                return True
            case ("buffer", "!"):
                return len(st.buffers.get(offer.channel, ())) < channel.size
            case ("buffer" | "overwrite", _):
                return bool(st.buffers.get(offer.channel))
            case ("broadcast", "?"):
                return any(me.branch in op.pending for op, _ in self.plain(st, offer.channel, "!"))
            case ("broadcast", _):
                return self._heard(st, offer.channel) >= set(self.linked.ends[offer.channel])
            case _:
                return bool(self.plain(st, offer.channel, OTHER[end]) or self._alternatives(st, offer, me))

    def listens(self, st: State, offer: Offer) -> None:
        """A guard begins to wait, and guards of the other side may be ready now.

        On a rendezvous only that of an interrupt finds any: it waits in parallel with its body even if it is ready at
        once.
        """
        channel = self.linked.channels.get(offer.channel)
        if channel is None or channel.kind in ("buffer", "overwrite"):
            return
        if offer.kind == "read":
            self.wake(st, offer.channel, "!")
        elif offer.kind == "write" and channel.kind != "broadcast":
            self.wake(st, offer.channel, "?")

    def _heard(self, st: State, channel: str) -> set[int]:
        """The ends of a broadcast at which a reader or a guard waits."""
        plain = {thread.branch for _, thread in self.plain(st, channel, "?")}
        return plain | {thread.branch for _, thread, _ in self.offers(st, channel, "?")}

    def _alternatives(self, st: State, offer: Offer, me: Thread) -> list[tuple[Offer, Thread, int | None]]:
        end = "?" if offer.kind == "read" else "!"
        found = [each for each in self.offers(st, offer.channel, OTHER[end]) if each[1] is not me]
        return sorted(found, key=lambda each: each[0].seq)

    def take(self, st: State, offer: Offer, me: Thread) -> Value | None:
        """Make the communication of a guard that is ready."""
        end = "?" if offer.kind == "read" else "!"
        op = Op(offer.channel, end, offer.value, offer.seq)
        kind = self.linked.channels[offer.channel].kind
        if kind in ("sync", "any") and not self.plain(st, offer.channel, OTHER[end]):
            other, thread, depth = self._alternatives(st, offer, me)[0]
            value = offer.value if end == "!" else other.value
            assert value is not None
            self.policy.passed(offer.channel, value, external=False)
            self._resolve(st, thread, other, depth, value)
            return value
        if kind == "broadcast":
            return self._together(st, offer, me)
        done = self.attempt(st, op, me)
        assert done.done
        return done.value

    def _together(self, st: State, offer: Offer, me: Thread) -> Value | None:
        """A broadcast that a guard has chosen: at each end first the reader that waits there, then the alternatives."""
        channel = offer.channel
        value = offer.value
        if offer.kind == "read":
            if any(me.branch in op.pending for op, _ in self.plain(st, channel, "!")):
                return self._receive(st, Op(channel, "?", None, offer.seq), me.branch).value
            other, thread, depth = self._alternatives(st, offer, me)[0]
            value = other.value
            assert value is not None
            self._resolve(st, thread, other, depth, value)
        assert value is not None
        guards = sorted(self.offers(st, channel, "?"), key=lambda each: each[0].seq)
        readers = {thread.branch: (op, thread) for op, thread in self.plain(st, channel, "?")}
        for end in self.linked.ends[channel]:
            self.policy.passed(channel, value, external=False)
            if offer.kind == "read" and end == me.branch:
                continue
            if end in readers:
                self.complete(st, readers[end][1], readers[end][0], value)
            else:
                guard, thread, depth = next(each for each in guards if each[1].branch == end)
                self._resolve(st, thread, guard, depth, value)
        return value

    def _resolve(self, st: State, thread: Thread, offer: Offer, depth: int | None, value: Value) -> None:
        """Another alternative has chosen this guard."""
        if depth is None:
            assert isinstance(thread.wait, Choice)
            thread.signal = ("chosen", thread.wait.node, offer.place, value)
            thread.wait = None
            self.ready(st, thread)
            return
        frame = thread.stack[depth]
        self.fire(st, thread, depth)
        chosen = Frame(frame.kind, frame.node, frame.at, None, "chosen", value)
        thread.stack = (*thread.stack[:depth], chosen, *thread.stack[depth + 1 :])
