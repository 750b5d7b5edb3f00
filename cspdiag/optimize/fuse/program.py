"""Fuses a program whose schedule is known at compile time into one process.

All processes are executed symbolically from the start, on the semantics of the language (``cspdiag.semantics``), until
a state repeats. What they did becomes the composition of one process: the occurrences before the loop, and a loop with
those that repeat. A rendezvous becomes an assignment and, for the trace, a report; samples are read and outputs written
as before.

When this is possible, and why nothing else can be observed from outside:

- *The whole program* is followed, from time 0, so the order of everything is known: computations, communications,
  samples and outputs have the same order in the fused process, at the same instants. A program is left as it is if
  only a part of it could be followed: an exception or a fault elsewhere would cancel the fused part in the middle of
  an instant, between two communications that are no longer points of cancellation, and its own exceptions would cancel
  the others earlier or later than before.
- *Unknown values make no difference.* Inputs without a period (events), interrupts, handlers of ``Fault`` and
  ``Timeout``, processes and control laws written by hand, variables that may be read before they are written, and
  guards and delays that depend on values are refused. Of the two paths of a decision that depends on a value one may
  continue forever; the other is followed to the end of the program, and is an exit of the fused process.
- *Faults* end the program in the middle of a computation. Its other processes would still have computed up to their
  next communication, but no process is left that could read their variables. For the same reason processes
  that are cancelled by an exception end immediately; a program that reads their variables afterwards is refused
  (``catch``).
- *A program that deadlocks* stays as it is, because the report names its processes; so does one that misses samples.
- *Samples* are taken at ends of the fused process, one for each original end. As one process they follow their periods
  together, and each from its first read on, which can differ from what several processes do. So the fused process may
  have to begin waiting for several inputs at once, by an alternative before the first sample, or to keep the ends of
  each process separate and close them where that process ended. The fused process is followed in the same way as the
  original program, must do the same at the same instants, and is discarded if it does not.
- *Priorities* and alternatives are accounted for in the order that was followed. In real time a fused process is late
  as a whole where one of several would have been; it then takes its samples in the same order, and misses them by the
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
from cspdiag.optimize.fuse.catch import refuse_visible_cancellation
from cspdiag.optimize.fuse.check import same_schedule
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.copies import without_copies
from cspdiag.optimize.fuse.follow import Repeats
from cspdiag.optimize.fuse.record import Step
from cspdiag.optimize.fuse.schedule import (
    Path,
    schedule,
    schedule_like,
    with_earliest_loop,
    with_first_iteration_before_loop,
    without_unread_counts,
)
from cspdiag.optimize.fuse.single_class import as_single_class

LARGEST_GROWTH = 8
"""A schedule that repeats only after a long time is a long text, and no faster to read or to compile than the
processes.
"""


def fuse(network: Network) -> Network:
    """The network as one process if its schedule is known; otherwise the same network."""
    try:
        return fused(network)
    except NotStaticError:
        return network


def explain_fusion(network: Network) -> tuple[str, ...]:
    """The result of fusion in lines of text, or the reason why a network is not fused."""
    try:
        fused(network)
    except NotStaticError as reason:
        return (f"{network.top} is not one process: {reason}",)
    processes = len(network.instances) - 1
    inside = "process" if processes == 1 else f"{processes} processes"
    return (f"{network.top} is one process, with the {inside} inside it fused by their schedule",)


def fused(network: Network) -> Network:
    """The network as one process. Raises NotStaticError."""
    top = network.class_named(network.top)
    assert isinstance(top, ProcessClass)
    if not any(isinstance(part, ParallelSteps) for entry in network.classes for part in _steps(entry)):
        raise NotStaticError("it is one process already")
    entry = as_single_class(network)
    refuse_visible_cancellation(entry)
    path = with_earliest_loop(without_unread_counts(schedule(entry, network.external_ports)))
    for together, closing in ((False, False), (True, False), (True, True)):
        fused_class, counters = _fused_class(entry, path, together=together, closing=closing)
        again = _schedule_of_fused(fused_class, path, counters, network)
        if again is not None and same_schedule(path, again, counters):
            assert fused_class.body is not None
            fused_class = replaced(fused_class, body=without_copies(fused_class.body))
            _refuse_growth(entry, fused_class)
            return remove_dead_parts(replaced(network, classes=(fused_class,)))
    raise NotStaticError("one process would take its samples at other instants")


def _refuse_growth(entry: ProcessClass, fused_class: ProcessClass) -> None:
    before, after = (sum(isinstance(part, ActionStep) for part in _steps(item)) for item in (entry, fused_class))
    if after > LARGEST_GROWTH * before:
        raise NotStaticError(f"the schedule, written down, is {after // before} times as long as the processes")


def _steps(entry: ProcessClass | SubmodelClass) -> Iterator[object]:
    return parts(entry.body) if isinstance(entry, ProcessClass) else iter(())


def _beginnings(path: Path) -> dict[int, tuple[End, ...]]:
    """The positions of samples that are awaited while processes begin to wait for other inputs, with the ends of all
    these inputs.
    """
    found: dict[int, tuple[End, ...]] = {}
    begun: set[End] = set()
    for position, step in enumerate(path.occurrences):
        if isinstance(step, Step) and isinstance(step.action, ReadValue) and isinstance(step.action.source, PortEnd):
            begun.add(step.action.source)
            if step.fresh:
                others = [end for end, since in path.followed.items() if since < step.time and end not in begun]
                if others:
                    found[position] = (step.action.source, *others)
                    begun.update(others)
    return found


def _fused_class(
    entry: ProcessClass, path: Path, *, together: bool, closing: bool
) -> tuple[ProcessClass, frozenset[str]]:
    """The class of the fused process, and the variables in it that count.

    ``together``: it begins to follow inputs at the same time as the processes did. ``closing``: the ends of each
    process stay separate, and are closed when it ends.
    """
    assert entry.body is not None
    followed = _beginnings(path) if together else {}
    if isinstance(path.outcome, Repeats) and any(position > path.outcome.position for position in followed):
        path = with_first_iteration_before_loop(path)
    names = {channel.name for channel in entry.channels}
    composition = PathWriter(path, entry.body, names, followed, closing=closing)
    guarded = {(e.port, e.index or 0) for ends in followed.values() for e in ends if isinstance(e, PortEnd)}
    fused_class = replaced(
        entry,
        body=_with_owners(entry.body, composition.body) if closing else composition.body,
        channels=(*entry.channels, *composition.variables),
        ports=tuple(_guarded(port, guarded) for port in entry.ports),
        creation=(*entry.creation, *map(CreatedChoice, composition.alternatives)),
    )
    return fused_class, composition.counters


def _guarded(port: Port, guarded: Container[tuple[str, int]]) -> Port:
    media = (
        replaced(medium, guarded_reads=True) if (port.name, index) in guarded else medium
        for index, medium in enumerate(port.media)
    )
    return replaced(port, media=tuple(media))


def _with_owners(before: Action, body: Action) -> Action:
    """The composition inside the scopes of all processes of ``before`` that have ends."""
    for part in parts(before):
        if isinstance(part, ProcessScope) and part.ends:
            body = replaced(part, body=body)
    return body


def _schedule_of_fused(
    fused_class: ProcessClass, path: Path, counters: frozenset[str], network: Network
) -> Path | None:
    try:
        return schedule_like(fused_class, network.external_ports, path, counters)
    except NotStaticError:
        return None
