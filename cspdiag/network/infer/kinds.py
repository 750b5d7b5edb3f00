"""Infers the kind of every channel from the relations of its users (language reference, the communication diagram)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from cspdiag.base import Diagnostic, Report
from cspdiag.network.diagnostics.channels import ChannelOneSided
from cspdiag.network.diagnostics.composition.parallel import EventReadInParallel, ParallelReaders, ParallelWriters, Race
from cspdiag.network.diagnostics.composition.sequence import BroadcastInSequence, RendezvousInSequence
from cspdiag.network.diagnostics.kinds import KindContradicts, KindsDisagree, MixedRelation
from cspdiag.network.relations import Pair, Relations, Uses, UsesByKey
from cspdiag.network.shapes import ChannelShape, Key, RequestedKind, Shape, attached_key, element_name
from cspdiag.syntax import ast

RequestedKinds: TypeAlias = "dict[Key, dict[str, RequestedKind]]"
"""The kinds that relationships request for each port and channel, in this process and inside its instances."""

_NOBODY = Uses()


def requested_kinds(shape: Shape, inside: Mapping[Shape, RequestedKinds]) -> RequestedKinds:
    """The kinds requested at the ports and channels of a shape; ``inside`` has those of its instances."""
    requested: RequestedKinds = {key: {kind.name: kind for kind in kinds} for key, kinds in shape.requested.items()}
    for channel in shape.channels.values():
        if channel.requested is not None:
            requested[channel.name] = {channel.requested.name: channel.requested}
    for instance in shape.instances.values():
        theirs = inside.get(instance.shape)
        if not theirs:
            continue
        for element, attached in instance.attachments.items():
            key, kinds = attached_key(attached), theirs.get(element_name(*element))
            if key is not None and kinds:
                ours = requested.setdefault(key, {})
                for name, kind in kinds.items():
                    ours.setdefault(name, kind)
    return requested


def excuse_unknown_uses(shape: Shape, relations: Relations) -> None:
    """Excuse what is connected to ports that an instance does not use as far as known, if an error was found in it."""
    for instance in shape.instances.values():
        inside = instance.shape
        if not (inside.incomplete or inside.has_unknown_uses):
            continue
        uses = relations.of(inside)
        for element, attached in instance.attachments.items():
            key = attached_key(attached)
            if key is None or element_name(*element) in uses:
                continue
            if key in shape.channels:
                shape.channels[key].excused = True
            else:
                shape.has_unknown_uses = True


def infer_kinds(shape: Shape, uses: UsesByKey, requested: RequestedKinds, report: Report) -> None:
    """Decides the kind of every channel of a shape, and reports relations that allow none."""
    for channel in shape.channels.values():
        use = uses.get(channel.name, _NOBODY)
        if channel.is_variable:
            _check_variable(channel, use, report)
        else:
            _infer(shape, channel, use, requested.get(channel.name, {}), report)


def _check_variable(channel: ChannelShape, use: Uses, report: Report) -> None:
    pair = use.parallel_writes or use.parallel
    if pair is not None and not channel.excused:
        channel.excused = True
        both_write = use.parallel_writes is not None
        report.add(Race(span=pair[0].span, variable=channel.name, one=pair[0], other=pair[1], both_write=both_write))


def _infer(shape: Shape, channel: ChannelShape, use: Uses, requested: dict[str, RequestedKind], report: Report) -> None:
    kind = _requested_kind(channel, requested, report)
    word = None if kind is None else kind.name
    channel.capacity = None if kind is None else kind.capacity
    channel.kind = word or ("sync" if use.parallel else "var")
    if channel.excused or shape.incomplete:
        return
    if isinstance(channel.declaration, ast.Channel) and (use.writer is None) != (use.reader is None):
        _refuse(
            channel, ChannelOneSided(span=channel.span, channel=channel.name, used=use.writer or use.reader), report
        )
    elif word in ("buffer", "overwrite"):
        _check_several(channel, use, word, report)
    elif use.parallel is None:
        _check_sequential(channel, use, kind, report)
    elif use.sequential is not None:
        mixed = MixedRelation(
            span=use.parallel[1].span, channel=channel.name, parallel=use.parallel, sequential=use.sequential
        )
        _refuse(channel, mixed, report)
    else:
        _check_several(channel, use, word, report)


def _requested_kind(channel: ChannelShape, requested: dict[str, RequestedKind], report: Report) -> RequestedKind | None:
    kinds = list(requested.values())
    if len(kinds) > 1:
        first, second = kinds[:2]
        report.add(KindsDisagree(span=second.span, channel=channel.name, kind=second.name, other=first))
        channel.excused = True
    return kinds[0] if kinds else None


def _check_sequential(channel: ChannelShape, use: Uses, kind: RequestedKind | None, report: Report) -> None:
    if use.parallel_observation is not None and kind is None:
        one, other = use.parallel_observation
        _refuse(channel, Race(span=one.span, variable=channel.name, one=one, other=other, both_write=False), report)
    if use.parallel_writes is not None and kind is None:
        one, other = use.parallel_writes
        _refuse(channel, Race(span=one.span, variable=channel.name, one=one, other=other, both_write=True), report)
    elif kind is not None and use.sequential is not None:
        writer, reader = use.sequential
        refused = RendezvousInSequence(
            span=kind.span, channel=channel.name, kind=kind.name, writer=writer, reader=reader
        )
        _refuse(channel, refused, report)


def _check_several(channel: ChannelShape, use: Uses, word: str | None, report: Report) -> None:
    writers, readers = _of_two(use.parallel_writes), _of_two(use.parallel_reads)
    if writers is not None and word != "any":
        one, other = writers
        refused = ParallelWriters(span=one.span, channel=channel.name, one=one, other=other, said=word, outermost=False)
        _refuse(channel, refused, report)
    if readers is not None and word not in ("any", "broadcast"):
        one, other = readers
        _refuse(channel, ParallelReaders(span=one.span, channel=channel.name, one=one, other=other, said=word), report)
    if word == "broadcast" and use.sequential_reads is not None:
        one, other = use.sequential_reads
        _refuse(channel, BroadcastInSequence(span=one.span, channel=channel.name, one=one, other=other), report)


def _of_two(pair: Pair | None) -> Pair | None:
    """A pair of different users; None for a pair of one instance, since that it runs twice at the same time is reported
    where it runs.
    """
    if pair is None:
        return None
    one, other = pair
    return None if one.instance and one.instance == other.instance else pair


def _refuse(channel: ChannelShape, diagnostic: Diagnostic, report: Report) -> None:
    channel.excused = True
    report.add(diagnostic)


def check_outermost(shape: Shape, uses: UsesByKey, requested: RequestedKinds, report: Report) -> None:
    """Reports uses of the ports of the outermost process that its environment, which neither waits nor blocks, does not
    allow.
    """
    for port, _, key in shape.port_elements():
        use, kinds = uses.get(key, _NOBODY), requested.get(key, {})
        writers, readers = _of_two(use.parallel_writes), _of_two(use.parallel_reads)
        refused = ["buffer", "overwrite", "sync"] if port.sampling is None else ["any", "buffer", "overwrite", "sync"]
        if port.direction == "out":
            refused = ["broadcast", "buffer", "overwrite", "sync"]
        contradicting = next((kinds[name] for name in refused if name in kinds), None)
        if len(kinds) > 1:
            first, second = list(kinds.values())[:2]
            report.add(KindsDisagree(span=second.span, channel=key, kind=second.name, other=first))
        elif contradicting is not None:
            sampled = port.sampling is not None
            report.add(
                KindContradicts(
                    span=contradicting.span,
                    port=key,
                    kind=contradicting.name,
                    direction=port.direction,
                    sampled=sampled,
                    declared=port.span,
                )
            )
        elif port.direction == "out" and writers is not None and "any" not in kinds:
            one, other = writers
            report.add(ParallelWriters(span=one.span, channel=key, one=one, other=other, said=None, outermost=True))
        elif port.direction == "in" and port.sampling is None and readers is not None and not kinds:
            one, other = readers
            report.add(EventReadInParallel(span=one.span, port=key, one=one, other=other, declared=port.span))
