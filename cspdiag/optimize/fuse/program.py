"""Fuses a program whose schedule is known at compile time into one process.

All processes are followed from the start, on the meaning of the language (``cspdiag.semantics``), until they are in a
state for the second time. What they did is written down as the composition of one process: what happened first, and a
loop with what happens again and again. A rendezvous in it is an assignment, and for the trace a report; samples are
read and outputs written where they were.

When that can be done, and why nothing else can be seen from outside:

- *The whole program* is followed, from time 0, so that the order of everything is known: computations, communications,
  samples and outputs stand in the fused process in the order in which they would have been done, at the same instants.
  A program of which only a part could be followed is left as it is: an exception or a fault of the others would cancel
  the part in the middle of an instant, between two communications that are not points of cancellation any more, and its
  own would cancel them earlier or later than they were.
- *What is not known does not matter.* Inputs without a period (events), interrupts, handlers of ``Fault`` and
  ``Timeout``, processes and control laws written by hand, variables that may be read before they are written, and
  guards and delays that depend on values are refused. A decision that depends on a value may have one way that goes on
  forever; the other is followed to the end of the program, and is an exit of the fused process.
- *Faults* end the program in the middle of a computation. Its other processes would still have computed up to their
  next communication, which nobody sees: there is nobody left to look at their variables. For the same reason processes
  that are cancelled by an exception end where they are; a program that looks at their variables afterwards is refused
  (``fuse_catch``).
- *A program that deadlocks* stays as it is, for the report names its processes; and so does one that misses samples.
- *Samples* are taken by ends of the fused process, one for each end there was. As one process they follow their periods
  together, and each from its first read on, which can differ from what several processes do. So it may have to begin to
  wait for several inputs at once, by an alternative before the first sample, or to keep the ends of each process apart
  and close them where it ended. The fused process is followed like any other, has to do the same at the same instants,
  and is given up if it does not.
- *Priorities* and alternatives have had their say in the order that was followed. In real time a fused process is late
  as a whole, where one of several would have been; it then takes its samples in the same order, and misses them by the
  same rule.
"""

from __future__ import annotations

from collections.abc import Container, Iterator

from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import Action, End, ParallelSteps, PortEnd, ProcessScope, ReadValue
from cspdiag.network.ir.actions import Step as ActionStep
from cspdiag.network.ir.network import CreatedChoice, Network, Port, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.dead.steps import remove_dead_parts
from cspdiag.optimize.fuse.actions import PathWriter
from cspdiag.optimize.fuse.catch import refuse_seen_cancellation
from cspdiag.optimize.fuse.check import same_schedule
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.copies import without_copies
from cspdiag.optimize.fuse.follow import Loops
from cspdiag.optimize.fuse.open import opened
from cspdiag.optimize.fuse.record import Step
from cspdiag.optimize.fuse.schedule import Path, schedule, schedule_like, with_loop_begun, with_loop_early

MOST_GROWTH = 8
"""The schedule of a program that only repeats after long is much text, and no faster to read or to compile than its
processes.
"""


def fuse(network: Network) -> Network:
    """The network as one process, where its schedule is known; otherwise as it is."""
    try:
        return fused(network)
    except NotStaticError:
        return network


def explain_fusion(network: Network) -> tuple[str, ...]:
    """Says, in lines for people, what fusion makes of a network, or why it makes nothing of it."""
    try:
        fused(network)
    except NotStaticError as reason:
        return (f"{network.top} is not one process: {reason}",)
    processes = len(network.instances) - 1
    return (f"{network.top} is one process, with the {processes} processes inside it fused by their schedule",)


def fused(network: Network) -> Network:
    """The network as one process. Raises NotStaticError."""
    top = network.class_named(network.top)
    assert isinstance(top, ProcessClass)
    if not any(isinstance(part, ParallelSteps) for entry in network.classes for part in _steps(entry)):
        raise NotStaticError("it is one process already")
    entry = opened(network)
    refuse_seen_cancellation(entry)
    path = with_loop_early(schedule(entry, network.external_ports))
    for together, closing in ((False, False), (True, False), (True, True)):
        single, counters = _single(entry, path, together=together, closing=closing)
        again = _followed_again(single, path, counters, network)
        if again is not None and same_schedule(path, again, counters):
            assert single.body is not None
            single = replaced(single, body=without_copies(single.body))
            _refuse_growth(entry, single)
            return remove_dead_parts(replaced(network, classes=(single,)))
    raise NotStaticError("one process would take its samples at other instants")


def _refuse_growth(entry: ProcessClass, single: ProcessClass) -> None:
    before, after = (sum(isinstance(part, ActionStep) for part in _steps(item)) for item in (entry, single))
    if after > MOST_GROWTH * before:
        raise NotStaticError(f"the schedule, written down, is {after // before} times as long as the processes")


def _steps(entry: ProcessClass | SubmodelClass) -> Iterator[object]:
    return parts(entry.body) if isinstance(entry, ProcessClass) else iter(())


def _beginnings(path: Path) -> dict[int, tuple[End, ...]]:
    """The positions of samples that are waited for while processes begin to wait for other inputs, with the ends of
    all.
    """
    found: dict[int, tuple[End, ...]] = {}
    begun: set[End] = set()
    for position, step in enumerate(path.happenings):
        if isinstance(step, Step) and isinstance(step.action, ReadValue) and isinstance(step.action.source, PortEnd):
            begun.add(step.action.source)
            if step.fresh:
                others = [end for end, since in path.followed.items() if since < step.time and end not in begun]
                if others:
                    found[position] = (step.action.source, *others)
                    begun.update(others)
    return found


def _single(entry: ProcessClass, path: Path, *, together: bool, closing: bool) -> tuple[ProcessClass, frozenset[str]]:
    """The class of the one process, and the variables in it that count.

    ``together``: it begins to follow inputs when the processes did. ``closing``: the ends of each process stay its own,
    and are closed when it ends.
    """
    assert entry.body is not None
    followed = _beginnings(path) if together else {}
    if isinstance(path.outcome, Loops) and any(position > path.outcome.position for position in followed):
        path = with_loop_begun(path)
    names = {channel.name for channel in entry.channels}
    composition = PathWriter(path, entry.body, names, followed, closing=closing)
    guarded = {(e.port, e.index or 0) for ends in followed.values() for e in ends if isinstance(e, PortEnd)}
    single = replaced(
        entry,
        body=_with_owners(entry.body, composition.body) if closing else composition.body,
        channels=(*entry.channels, *composition.variables),
        ports=tuple(_guarded(port, guarded) for port in entry.ports),
        creation=(*entry.creation, *map(CreatedChoice, composition.alternatives)),
    )
    return single, composition.counters


def _guarded(port: Port, guarded: Container[tuple[str, int]]) -> Port:
    media = (
        replaced(medium, guarded_reads=True) if (port.name, index) in guarded else medium
        for index, medium in enumerate(port.media)
    )
    return replaced(port, media=tuple(media))


def _with_owners(before: Action, body: Action) -> Action:
    """The composition within all processes of the one before that have ends."""
    for part in parts(before):
        if isinstance(part, ProcessScope) and part.ends:
            body = replaced(part, body=body)
    return body


def _followed_again(single: ProcessClass, path: Path, counters: frozenset[str], network: Network) -> Path | None:
    try:
        return schedule_like(single, network.external_ports, path, counters)
    except NotStaticError:
        return None
