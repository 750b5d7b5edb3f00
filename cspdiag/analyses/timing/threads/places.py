"""The places of threads: what each computes, what it waits for, and where it continues."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cache
from typing import Any

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import Missing, Move, Offer, Place, Thread
from cspdiag.analyses.timing.threads.offers import ChannelEnds
from cspdiag.analyses.timing.threads.termination import Termination, Values, without_changed
from cspdiag.base.record import record, replaced
from cspdiag.network.ir.actions import Branch, CoreAction, Event, PortEnd, Step
from cspdiag.network.ir.declared import Declared, DeclaredElement
from cspdiag.network.ir.expressions import Expression, VariableValue
from cspdiag.network.ir.network import Connection, CoreNetwork, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts


@record
class Context:
    """The surroundings of an action: its thread and process, what may end it early, and the stated execution time that
    replaces those inside it.

    ``before`` gives the values of variables that are known when the action begins; ``runs_once`` means that it begins
    only once.
    """

    thread: Thread
    path: str
    priority: tuple[int, ...]
    handlers: tuple[tuple[str, int], ...] = ()
    interrupts: tuple[Offer, ...] = ()
    stated: int | None = None
    before: Callable[[], Values] = dict
    runs_once: bool = False

    def after_partial(self, *by: CoreAction | Event) -> Context:
        """The context after a part of some actions may have been executed."""
        return replaced(self, before=cache(lambda: without_changed(self.before(), *by)))


class Places:
    """Makes the places of threads.

    ``missing`` are the laws without a worst-case execution time, ``measured`` the times by path, in nanoseconds, that
    are used instead of stated ones. ``unseen`` are the refusals of processes whose communications cannot be analysed.
    """

    def __init__(self, network: CoreNetwork, measured: Mapping[str, int]) -> None:
        self.network = network
        self.measured = measured
        self.classes = {entry.name: entry for entry in network.classes}
        self.instances = {instance.path: instance for instance in network.instances}
        self.channel_ends = ChannelEnds(network)
        self.termination = Termination(self.channel_ends)
        self.missing: dict[str, Missing] = {}
        self.unseen: list[Refusal] = []

    def place(self, context: Context, where: Step | Declared | DeclaredElement, **fields: Any) -> int:
        """Add a place to a thread; returns its number."""
        context.thread.places.append(Place(where.span, context.path, **fields))
        return len(context.thread.places) - 1

    def cost(self, path: str, entry: ProcessClass | SubmodelClass, context: Context) -> int:
        """The worst-case execution time in nanoseconds; 0 within a process that states its time."""
        if context.stated is not None:
            return 0
        stated = self.measured.get(path, entry.wcet)
        if stated is None:
            kind = "submodel" if isinstance(entry, SubmodelClass) else "process"
            self.missing.setdefault(path, Missing(path, entry.definition, kind, entry.span))  # type: ignore[arg-type]
            return 0
        return stated

    def waiting(
        self, context: Context, where: Step | Declared | DeclaredElement, offers: list[Offer], following: int
    ) -> int:
        """A place that waits for one of ``offers``; ``following`` if it never waits."""
        if not offers:
            return following
        waits = self.place(context, where)
        place = context.thread.places[waits]
        place.offers = [replaced(offer, target=self.resumed(context, where, offer.target)) for offer in offers]
        self.interruptible(place, context)
        return waits

    def resumed(self, context: Context, where: Step | Declared | DeclaredElement, target: int) -> int:
        """The place where a thread continues after a wait.

        Within a process that states its time, every step takes that long; where a fault is caught, the next computation
        may fault.
        """
        fault = self.handler(context, "Fault")
        if context.stated is None and fault is None:
            return target
        leaf = "" if context.stated is None else context.path
        resumed = self.place(context, where, cost=context.stated or 0, leaf=leaf)
        context.thread.places[resumed].successors = [target] if fault is None else [target, fault]
        return resumed

    def interruptible(self, place: Place, context: Context) -> None:
        """Add the offers that may end a wait from outside: interrupts, and missed samples."""
        missed = [(offer, self.handler(context, "Timeout")) for offer in place.offers if offer.kind == "sample"]
        place.offers += [replaced(offer, target=target) for offer, target in missed if target is not None]
        place.offers += context.interrupts

    def handler(self, context: Context, exception: str) -> int | None:
        """Where an exception is caught; None if it leaves the thread."""
        return next((target for name, target in reversed(context.handlers) if name == exception), None)

    def move(self, path: str, connections: Iterable[Connection], inputs: Collection[str]) -> Move:
        """From which nets a law or a process written by hand computes, and to which."""
        nets = [(self.channel_ends.net(path, PortEnd(c.port, c.index)), c.port in inputs) for c in connections]
        reads = frozenset(net.path for net, is_read in nets if net is not None and is_read)
        return Move(reads, frozenset(net.path for net, is_read in nets if net is not None and not is_read))

    def faults(self, context: Context) -> list[int]:
        """Where a computation that may fault continues, if the fault is caught."""
        fault = self.handler(context, "Fault")
        return [] if fault is None else [fault]

    def may_hold(self, branch: Branch[CoreAction], context: Context) -> bool:
        """Whether the condition of a guard may be true."""
        return branch.condition is None or self.channel_ends.constant(context.path, branch.condition) is not False

    def must_hold(self, branch: Branch[CoreAction], context: Context) -> bool:
        """Whether a guard has no condition, or one that is always true."""
        return branch.condition is None or self.channel_ends.constant(context.path, branch.condition) is True


def variables_in(path: str, value: Expression) -> frozenset[str]:
    """The variables of a process from which a value is computed."""
    return frozenset(f"{path}.{part.channel}" for part in parts(value) if isinstance(part, VariableValue))
