"""Guards on buttons: a `bool` event comes when it is pressed and when it is released, and the value says which."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from cspdiag.model.types import BoolType
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.composition.alternatives import ReleaseNotToldApart
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.ir.actions import Branch, Choice, CoreAction, InputEvent, InterruptOn, ReadValue, ReadyEvent
from cspdiag.network.ir.walk import all_actions
from cspdiag.network.relations import end_key, variables_read
from cspdiag.network.shapes import Key, attached_key


def check_releases(placed: Placed, agreement: Agreement) -> None:
    """Find guards on `bool` events whose value is not looked at; where the event is read elsewhere too, that may
    be the release.
    """
    shape = placed.shape
    if shape.body is None or shape.incomplete:
        return
    guards = [(branch, is_interrupt) for branch, is_interrupt in _guards(shape.body) if _is_button(placed, branch)]
    if not guards:
        return
    reads = Counter(_reads(placed, shape.body))
    looked_at = {value.channel for value in variables_read(shape.body)}
    looked_at |= {attached_key(a) or "" for instance in shape.instances.values() for a in instance.attachments.values()}
    for branch, is_interrupt in guards:
        assert isinstance(branch.event, InputEvent)
        key, variable = end_key(branch.event.source), branch.event.target.channel
        if variable not in looked_at and reads[key] == 1:
            agreement.found(
                ReleaseNotToldApart(span=branch.event.span, port=key, variable=variable, is_interrupt=is_interrupt)
            )
        else:
            agreement.refuted(ReleaseNotToldApart, branch.event.span)


def _guards(body: CoreAction) -> Iterator[tuple[Branch[CoreAction], bool]]:
    for action in all_actions(body):
        if isinstance(action, Choice):
            for branch in action.branches:
                yield branch, False
        elif isinstance(action, InterruptOn):
            yield action.branch, True


def _is_button(placed: Placed, branch: Branch[CoreAction]) -> bool:
    if not isinstance(branch.event, InputEvent) or branch.condition is not None:
        return False
    key = end_key(branch.event.source)
    return placed.facts[key][0] == "event" and isinstance(placed.shape.port_or_channel_type(key), BoolType)


def _reads(placed: Placed, body: CoreAction) -> Iterator[Key]:
    """Each place of the process where something is read, or handed to an instance to be read."""
    for action in all_actions(body):
        if isinstance(action, ReadValue):
            yield end_key(action.source)
    for branch, _ in _guards(body):
        if isinstance(branch.event, InputEvent | ReadyEvent):
            yield end_key(branch.event.source)
    for instance in placed.shape.instances.values():
        yield from (key for key in map(attached_key, instance.attachments.values()) if key is not None)
