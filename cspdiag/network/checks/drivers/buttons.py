"""Guards on buttons: a `bool` event occurs on a press and on a release, and its value distinguishes them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from cspdiag.model.types import BoolType
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.composition.alternatives import ReleaseNotDistinguished
from cspdiag.network.flow.code import Code, Select, Watch
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.own_uses import own_reads
from cspdiag.network.ir.actions import Branch, InputEvent, InterruptOn
from cspdiag.network.relations import end_key, variables_read
from cspdiag.network.shapes import attached_key


def check_releases(placed: Placed, agreement: Agreement) -> None:
    """Find guards on `bool` events whose value is not used; an event that is also read elsewhere is excepted, because
    that may be the release.
    """
    shape = placed.shape
    if shape.body is None or shape.incomplete:
        return
    guards = [(branch, is_interrupt) for branch, is_interrupt in _guards(shape.flow) if _is_button(placed, branch)]
    if not guards:
        return
    attached = [attached_key(a) for instance in shape.instances.values() for a in instance.attachments.values()]
    reads = Counter([*own_reads(shape), *attached])
    variables = {*attached, *(value.channel for value in variables_read(shape.body))}
    for branch, is_interrupt in guards:
        assert isinstance(branch.event, InputEvent)
        key, variable = end_key(branch.event.source), branch.event.target.channel
        if variable not in variables and reads[key] == 1:
            agreement.claim(
                ReleaseNotDistinguished(span=branch.event.span, port=key, variable=variable, is_interrupt=is_interrupt)
            )
        else:
            agreement.refute(ReleaseNotDistinguished, branch.event.span)


def _guards(code: Code) -> Iterator[tuple[Branch, bool]]:
    """The guards, each with whether it is that of an interrupt."""
    for instruction in code.instructions:
        match instruction:
            case Select(step=choice):
                yield from ((branch, False) for branch in choice.branches)
            case Watch(step=InterruptOn(branch=branch)):
                yield branch, True
            case _:  # No other instruction has guards.
                pass


def _is_button(placed: Placed, branch: Branch) -> bool:
    if not isinstance(branch.event, InputEvent) or branch.condition is not None:
        return False
    key = end_key(branch.event.source)
    return placed.facts[key][0] == "event" and isinstance(placed.shape.port_or_channel_type(key), BoolType)
