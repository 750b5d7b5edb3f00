"""Alternatives and the guards of interrupts: when they are ready, and which is chosen."""

from __future__ import annotations

from tests.oracle.machine.core import CANCEL, Core, MustWaitError
from tests.oracle.machine.laws import assign
from tests.oracle.machine.link import Node
from tests.oracle.machine.state import Choice, Frame, Offer, Signal, State, Thread
from tests.oracle.machine.values import evaluate, nanoseconds, stored
from tests.oracle.programs.tree import After, Alt, Guarded, Interrupt, Read, Ready, Value, Write


class Guards(Core):
    def _offer(self, st: State, index: int, node: Node) -> Offer | None:
        """The guard when its alternative begins, if its condition holds."""
        guard = node.comp
        assert isinstance(guard, Guarded)
        if guard.when is not None and not evaluate(guard.when, st.variables):
            return None
        st.seq += 1
        match guard.event:
            case Read(channel, _):
                return Offer(index, "read", channel, None, 0, st.seq, self.linked.sessions.get((node.id, channel), 0))
            case Write(channel, value):
                return Offer(index, "write", channel, stored(evaluate(value, st.variables)), 0, st.seq)
            case After(time, at):
                due = nanoseconds(time, st.variables) + (0 if at else st.now)
                return Offer(index, "after", "", None, due, st.seq)
            case Ready(channel):
                return Offer(index, "ready", channel, None, 0, st.seq, self.linked.sessions.get((node.id, channel), 0))
            case _:
                return Offer(index, "skip", "", None, 0, st.seq)

    def _alternative(self, st: State, thread: Thread, node: Node, offers: tuple[Offer, ...]) -> Signal:
        if thread.cancel:
            return CANCEL
        thread.stack += (Frame("alt", node.id),)
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
                return self.clock.available(st, thread, offer.channel, offer.session)
            case _:
                return self.channels.possible(st, offer, thread)

    def _choose(self, st: State, thread: Thread, choice: Choice) -> Signal:
        ready = [offer for offer in choice.offers if self._is_ready(st, thread, offer)]
        if not ready:
            for offer in choice.offers:
                if self._sampled(offer):
                    self.clock.follow(st, thread, offer.channel, offer.session)
                self.channels.listens(st, offer)
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
        if self._sampled(offer):
            self.clock.follow(st, thread, offer.channel, offer.session)
        value: Value | None = None
        if offer.kind in ("read", "write"):
            value = self._take(st, thread, offer)
        return ("chosen", node.id, offer.place, value)

    def _take(self, st: State, thread: Thread, offer: Offer) -> Value | None:
        if offer.channel not in self.linked.ports:
            return self.channels.take(st, offer, thread)
        if offer.kind == "read":
            return self.clock.read(st, thread, offer.channel, offer.session)
        assert offer.value is not None
        self.clock.write(st, offer.channel, offer.value)
        return None

    def _chosen(self, st: State, node: Node, index: int, value: Value | None) -> Signal:
        """What follows a guard that was chosen: of an alternative, of a guarded process alone, or of an interrupt."""
        guard = node.inner[index] if isinstance(node.comp, Alt) else node
        if isinstance(node.comp, Interrupt):
            guard = node.inner[1]
        st.chosen[node.id] = index
        assert isinstance(guard.comp, Guarded)
        if isinstance(guard.comp.event, Read):
            assert value is not None
            assign(st, guard.comp.event.target, value)
        return ("exec", guard.inner[0].id)
