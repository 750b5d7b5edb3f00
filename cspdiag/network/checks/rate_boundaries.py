"""Control laws of different rates that wait for each other over a channel, so the faster one misses samples.

A law keeps a pace if a loop of its process runs it and nothing else there reads one of its sampled inputs. Each channel
and port is traced, inside out, to the single law with a pace that writes or reads it; if a channel connects two
different paces, the faster law waits.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from cspdiag.base import Report, Span
from cspdiag.base.record import record
from cspdiag.network.diagnostics.samples.rates import FasterLawWaits
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.own_uses import own_uses
from cspdiag.network.infer.waiting import sample_period
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import Direction
from cspdiag.network.ir.walk import instances_run
from cspdiag.network.shapes import InstanceShape, Key, attached_key, element_name

_WAITING_KINDS = frozenset({"sync", "broadcast", "buffer", "overwrite"})


@record
class Pace:
    """A law that takes each sample of an input: its path, its period in nanoseconds, and that input."""

    path: str
    period: int
    sampled: Key
    span: Span
    """The connection of the sampled input to the law."""


@record
class LawEnd:
    """The only law that writes or reads a channel, with the path of its port."""

    pace: Pace
    port: str
    span: Span
    """The connection of the channel to the law, or to the process that contains it."""


_Ends = dict[tuple[Key, Direction], LawEnd | None]
"""The law for each channel or port that is written or read; None if it is not a single law with a pace."""


class RateBoundaries:
    """Finds channels between laws of different rates; the contexts of instances must be processed first."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self._known: dict[Placed, _Ends] = {}

    def process(self, placed: Placed) -> None:
        """Report the channels of a process that delay a law."""
        shape = placed.shape
        ends: _Ends = {}
        self._known[placed] = ends
        if shape.body is None or shape.incomplete:
            return
        writes, reads = own_uses(shape)
        ends.update({(key, "out"): None for key in writes})
        ends.update({(key, "in"): None for key in reads})
        paces = _paces(placed, frozenset(reads))
        for instance in shape.instances.values():
            for end in self._ends_of(placed, instance, paces.get(instance.name)):
                key, direction, law = end
                ends[key, direction] = None if (key, direction) in ends else law
        for channel in shape.channels:
            if placed.facts[channel][0] in _WAITING_KINDS:
                self._check(placed, channel, ends.get((channel, "out")), ends.get((channel, "in")))

    def _ends_of(
        self, placed: Placed, instance: InstanceShape, pace: Pace | None
    ) -> Iterator[tuple[Key, Direction, LawEnd | None]]:
        """The laws at the ports of an instance: the instance itself, or those inside it."""
        inside = None if instance.shape.is_submodel else self._known.get(placed.inside[instance.name], {})
        for element, attached in instance.attachments.items():
            key, direction = attached_key(attached), instance.shape.ports[element[0]].direction
            if key is None:
                continue
            name = element_name(*element)
            law = None
            if inside is None and pace is not None:
                law = LawEnd(pace, f"{instance.name}.{name}", attached.span)
            elif inside is not None and (end := inside.get((name, direction))) is not None:
                within = end.pace
                path = f"{instance.name}.{within.path}"
                outer = Pace(path, within.period, within.sampled, within.span)
                law = LawEnd(outer, f"{instance.name}.{end.port}", attached.span)
            yield key, direction, law

    def _check(self, placed: Placed, channel: Key, writer: LawEnd | None, reader: LawEnd | None) -> None:
        if writer is None or reader is None or writer.pace.period == reader.pace.period:
            return
        is_writer = writer.pace.period < reader.pace.period
        if is_writer and placed.facts[channel][0] == "overwrite":
            return
        fast, slow = (writer, reader) if is_writer else (reader, writer)
        self.report.add(
            FasterLawWaits(
                span=fast.span,
                law=fast.pace.path,
                port=fast.port,
                period=fast.pace.period,
                sampled=fast.pace.sampled,
                sampled_span=fast.pace.span,
                slower=slow.pace.path,
                slower_port=slow.port,
                slower_period=slow.pace.period,
                slower_span=slow.pace.span,
                is_writer=is_writer,
            )
        )


def _paces(placed: Placed, read_by_process: frozenset[Key]) -> dict[str, Pace]:
    """The laws of a process that keep a pace, by instance."""
    shape = placed.shape
    assert shape.body is not None
    runs = Counter(instances_run(shape.body))
    readers: dict[Key, int] = dict.fromkeys(read_by_process, 2)
    for instance in shape.instances.values():
        for key in dict(_inputs(instance)) if instance.shape.is_submodel else ():
            readers[key] = readers.get(key, 0) + 1
    found = {}
    for name in _repeated(shape.body):
        instance, period = shape.instances[name], placed.samples.get(name)
        if period is None or runs[name] > 1 or not instance.shape.is_submodel or not _agrees(placed, instance, period):
            continue
        for key, span in _inputs(instance):
            if sample_period(placed, key) == period and readers[key] == 1:
                found[name] = Pace(name, period, key, span)
                break
    return found


def _agrees(placed: Placed, instance: InstanceShape, period: int) -> bool:
    """Whether the law is connected only to nets of this period; other cases have already been reported."""
    keys = map(attached_key, instance.attachments.values())
    samplings = [placed.sampling(key) for key in keys if key is not None]
    return all(sampling is None or sampling.period == period for sampling in samplings)


def _inputs(instance: InstanceShape) -> Iterator[tuple[Key, Span]]:
    for element, attached in instance.attachments.items():
        key = attached_key(attached)
        if key is not None and instance.shape.ports[element[0]].direction == "in":
            yield key, attached.span


def _repeated(body: ir.CoreAction) -> Iterator[str]:
    """The instances that run in every iteration of a loop."""
    pending = [(body, False)]
    while pending:
        action, is_repeated = pending.pop()
        match action:
            case ir.RunInstance():
                if is_repeated:
                    yield action.instance
            case ir.Repeat() | ir.WhileLoop():
                pending.append((action.body, True))
            case ir.SequentialSteps() | ir.ParallelSteps():
                pending.extend((step, is_repeated) for step in action.steps)
            case ir.CountedLoop() | ir.Group() | ir.CatchException() | ir.InterruptOn():
                pending.append((action.body, is_repeated))
            case _:
                # What is chosen, or follows an exception, does not run in every iteration.
                pass
