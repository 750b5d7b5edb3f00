"""Communications that a process performs itself, and the laws that it runs."""

from __future__ import annotations

from collections.abc import Sequence

from tests.oracle.machine.core import CANCEL, NEXT, Core, MustWaitError
from tests.oracle.machine.link import Node
from tests.oracle.machine.state import Frame, Joint, Op, Signal, State, Thread
from tests.oracle.machine.values import evaluate, stored
from tests.oracle.programs.tree import Event, Guarded, Read, Run, Target, Value, Write


def assign(st: State, target: Target, value: Value) -> None:
    if target.at is not None:
        whole = st.variables[target.name]
        assert isinstance(whole, tuple)
        value = (*whole[: target.at], value, *whole[target.at + 1 :])
    st.variables[target.name] = stored(value)


class Laws(Core):
    def _communicate(self, st: State, thread: Thread, node: Node, kind: str, event: Event) -> Signal:
        if isinstance(event, Read):
            return self._joint(st, thread, Frame(kind, node.id), "?", [(event.channel, None)])
        assert isinstance(event, Write)
        value = stored(evaluate(event.value, st.variables))
        return self._joint(st, thread, Frame(kind, node.id), "!", [(event.channel, value)])

    def _joint(
        self, st: State, thread: Thread, frame: Frame, end: str, requested: Sequence[tuple[str, Value | None]]
    ) -> Signal:
        """Communications that are performed together; what is available is taken in their order."""
        if thread.cancel:
            return CANCEL
        thread.stack += (frame,)
        ops: list[Op] = []
        for channel, value in requested:
            st.seq += 1
            op = Op(channel, end, value, st.seq, session=self.linked.sessions.get((frame.node, channel), 0))
            if channel not in self.linked.ports:
                op = self.channels.attempt(st, op, thread)
            elif end == "?" and self.linked.ports[channel].period is not None:
                self.clock.follow(st, thread, channel, op.session)
            ops.append(op)
        thread.wait = Joint(tuple(ops))
        return ("retry",)

    def _retry(self, st: State, thread: Thread) -> Signal:
        """Take what has arrived at external inputs."""
        assert isinstance(thread.wait, Joint)
        ops = list(thread.wait.ops)
        for index, op in enumerate(ops):
            if op.done or op.channel not in self.linked.ports:
                continue
            if op.end == "!":
                assert op.value is not None
                self.clock.write(st, op.channel, op.value)
                ops[index] = op._replace(done=True)
            elif self.clock.available(st, thread, op.channel, op.session):
                ops[index] = op._replace(done=True, value=self.clock.read(st, thread, op.channel, op.session))
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
                assign(st, target, ops[0].value)
            case "guard", Guarded(event, _, _):
                if isinstance(event, Read):
                    assert ops[0].value is not None
                    assign(st, event.target, ops[0].value)
                return ("exec", node.inner[0].id)
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
        outputs = [(sink, stored(evaluate(expr, names))) for _, _, sink, expr in law.outputs]
        st.laws[name] = tuple(stored(evaluate(following, names)) for _, _, _, following in law.states)
        self.clock.elapse(st, self.policy.compute(law))
        written: list[tuple[str, Value | None]] = []
        for sink, value in outputs:
            if sink in self.linked.ports:
                written.append((sink, value))
            elif sink != "_":
                st.variables[sink] = value
        return self._joint(st, thread, Frame("law-out", node.id), "!", written)
