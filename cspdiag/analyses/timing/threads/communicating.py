"""The places at which values are passed on: communications, the laws between them, and processes written by hand."""

from __future__ import annotations

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import Move, Offer
from cspdiag.analyses.timing.threads.offers import never_waits
from cspdiag.analyses.timing.threads.places import Context, Places, variables_in
from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import ChannelEnd, CoreAction, InputEvent, OutputEvent, PortEnd, ReadValue, WriteValue
from cspdiag.network.ir.network import Connection, CoreClass, SubmodelClass


class Communicating(Places):
    """Makes the places for reading, computing and writing."""

    def written_by_hand(self, path: str, entry: CoreClass, context: Context, following: int) -> int:
        """The place of a process written by hand: it waits for any of its ports, computes, and waits again, until it
        ends.
        """
        cost = self.cost(path, entry, context)
        ports = [(port, k) for port in entry.ports for k in ((None,) if port.size is None else range(port.size))]
        ends = [(self.channel_ends.net(path, PortEnd(port.name, k)), port.direction) for port, k in ports]
        move = Move(
            frozenset(net.path for net, direction in ends if net is not None and direction == "in"),
            frozenset(net.path for net, direction in ends if net is not None and direction == "out"),
        )
        outputs = tuple(net.path for net, _ in ends if net is not None and net.external == "out")
        sends = tuple(net.path for net, _ in ends if net is not None and never_waits(net))
        work = self.place(context, entry, cost=cost, leaf=path, outputs=outputs, sends=sends, move=move)
        context.thread.places[work].is_by_hand = True
        waits = self.place(context, entry)
        place = context.thread.places[waits]
        for port, k in ports:
            end = PortEnd(port.name, k)
            if port.direction == "in":
                offers = self.channel_ends.reading(path, end, work, entry)
                place.offers += offers
                self.unseen += [_unseen(path, port.name, entry) for offer in offers if offer.kind == "sample"]
            else:
                place.offers += self.channel_ends.writing(path, end, work, entry)
        context.thread.places[work].successors = [waits, following] if place.offers else [following]
        self.interruptible(place, context)
        return waits if place.offers else work

    def law(
        self,
        path: str,
        law: SubmodelClass,
        connections: tuple[Connection, ...],
        context: Context,
        following: int,
        where: CoreAction,
    ) -> int:
        """The place of one run of a law: it waits for its inputs, computes, and writes its outputs."""
        inputs = {port.name for port in law.ports if port.direction == "in"}
        present = following
        for connection in reversed(connections):
            if connection.port not in inputs:
                offers = self.channel_ends.writing(path, PortEnd(connection.port, connection.index), present, where)
                present = self.waiting(context, where, offers, present)
        names = [port.name for port in law.ports if port.direction == "out"]
        nets = [self.channel_ends.net(path, PortEnd(c.port, c.index)) for c in connections if c.port in names]
        outputs = tuple(net.path for net in nets if net is not None and net.external == "out")
        sends = tuple(net.path for net in nets if net is not None and never_waits(net))
        work = self.place(
            context, law, cost=self.cost(path, law, context), leaf=path, outputs=outputs, sends=sends,
            move=self.move(path, connections, inputs)
        )  # fmt: skip
        fault = self.handler(context, "Fault")
        context.thread.places[work].successors = [present] if fault is None else [present, fault]
        present = work
        # The sample comes first: it begins the work of a period.
        reads: list[Offer] = []
        for connection in connections:
            attached = connection.attachment
            if connection.port in inputs and isinstance(attached, PortEnd | ChannelEnd):
                end = PortEnd(connection.port, connection.index, attached.end)
                reads += self.channel_ends.reading(path, end, 0, where, owner=context.path)
        for offer in sorted(reads, key=lambda offer: ("partner", "event", "sample").index(offer.kind)):
            present = self.waiting(context, where, [replaced(offer, target=present)], present)
        return present

    def copied(self, context: Context, action: ReadValue | InputEvent, following: int) -> int:
        """The place at which a value is read into a variable."""
        net = self.channel_ends.net(context.path, action.source)
        read = frozenset() if net is None else frozenset([net.path])
        move = Move(read, frozenset([f"{context.path}.{action.target.channel}"]))
        return self.place(context, action, successors=[following, *self.faults(context)], move=move)

    def handed_over(self, context: Context, action: WriteValue | OutputEvent, following: int) -> int:
        """The place at which a value is passed to a channel or an output."""
        net = self.channel_ends.net(context.path, action.sink)
        if net is None:
            return following
        move = Move(variables_in(context.path, action.value), frozenset([net.path]))
        outputs = (net.path,) if net.external == "out" else ()
        sends = (net.path,) if never_waits(net) else ()
        return self.place(
            context, action, successors=[following, *self.faults(context)], outputs=outputs, sends=sends, move=move
        )

    def written(self, context: Context, action: WriteValue, following: int) -> int:
        """The place at which a value is computed and, once its reader takes it, passed to a channel or an output."""
        offers = self.channel_ends.writing(context.path, action.sink, following, action)
        return self.handed_over(context, action, self.waiting(context, action, offers, following))


def _unseen(path: str, port: str, entry: CoreClass) -> Refusal:
    """Refuse a process written by hand that reads a sampled input."""
    reason = f"its body is written by hand, and whether it takes each sample of `{port}` cannot be seen"
    advice = f"read `{port}` in a composition, and let a submodel that is written by hand compute with it"
    return Refusal(path, reason, entry.span, advice)
