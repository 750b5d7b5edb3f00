"""A ready guard promises a read: the process behind ``port -> P`` begins by reading that port.

On every path through ``P`` the port must be read before anything that may have to wait. What never waits may come
first: ``skip``, ``:=``, ``reset``, reading a ``var`` channel or a default, writing an output of the outermost process.
A submodel reads all its inputs at once; besides the port of the guard it may read what never waits, and sampled inputs
of the same period that this process reads only together with that port, because they are ready at the same instant.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias, assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import record
from cspdiag.network.diagnostics.composition.alternatives import GuardNotRead
from cspdiag.network.flow.code import Take
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.waiting import inputs_of, is_open, is_over_at_once, read_may_wait, write_may_wait
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.walk import all_actions
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import UNKNOWN_SAMPLING, InstanceShape, Key, attached_key, element_name


@record
class ReadsPort:
    """The port is read before anything that may wait."""


@record
class NeverWaits:
    """Neither the port is read, nor anything waits."""


@record
class WaitsFirst:
    """Something that may wait comes first; ``what`` describes it."""

    span: Span
    what: str
    other_input: str | None = None
    """An input that is read together with the guard's port and may not be ready."""


Beginning: TypeAlias = ReadsPort | NeverWaits | WaitsFirst

_READS_PORT, _NEVER_WAITS = ReadsPort(), NeverWaits()
_LARGEST_DEPTH = 100
"""Levels of hierarchy that are searched; deeper processes are assumed to read the port first."""


def check_guards(placed: Placed, report: Report) -> None:
    """Report every ready guard whose process does not begin by reading the guard's port."""
    if placed.shape.body is None or placed.shape.incomplete:
        return
    for instruction in placed.shape.flow.instructions:
        if isinstance(instruction, Take):
            _check(placed, instruction.branch, report)


def _check(placed: Placed, branch: ir.Branch[ir.CoreAction], report: Report) -> None:
    if not isinstance(branch.event, ir.ReadyEvent):
        return
    key = end_key(branch.event.source)
    if is_open(placed, key):
        return
    found = _Beginnings(placed, key, 0).of(branch.body)
    match found:
        case ReadsPort():
            return
        case NeverWaits():
            found = WaitsFirst(branch.body.span, "the branch ends without reading it")
        case WaitsFirst():
            pass
        case _:
            assert_never(found)
    report.add(
        GuardNotRead(span=branch.event.span, port=key, first=found.span, what=found.what, beside=found.other_input)
    )


class _Beginnings:
    """How actions of one process begin, with regard to one port or channel."""

    def __init__(self, placed: Placed, key: Key | None, depth: int) -> None:
        self.placed = placed
        self.key = key
        self.depth = depth

    def of(self, action: ir.CoreAction) -> Beginning:
        match action:
            case ir.RunInstance():
                instance = self.placed.shape.instances[action.instance]
                return (
                    self._law(instance, action.span) if instance.shape.is_submodel else self._process(instance, action)
                )
            case ir.ReadValue():
                return self._read(end_key(action.source), action.span)
            case ir.WriteValue():
                key = end_key(action.sink)
                waits = write_may_wait(self.placed, key) and not is_open(self.placed, key)
                return WaitsFirst(action.span, f"the branch writes `{key}` first") if waits else _NEVER_WAITS
            case ir.AssignValue() | ir.SkipStep() | ir.ResetInstance():
                return _NEVER_WAITS
            case ir.WaitStep() if is_over_at_once(self.placed, action.duration):
                return _NEVER_WAITS
            case ir.WaitStep() | ir.StopStep() | ir.RaiseException():
                return WaitsFirst(action.span, "the branch does not begin by reading it")
            case ir.SequentialSteps():
                return self._first(action.steps)
            case ir.ParallelSteps():
                return _of_parallel(map(self.of, action.steps))
            case ir.Choice():
                return _of_alternatives(map(self._branch, action.branches), action.span)
            case ir.Repeat() | ir.CountedLoop() | ir.Group():
                return self.of(action.body)
            case ir.WhileLoop():
                found = self.of(action.body)
                return (
                    WaitsFirst(action.span, "the branch may end without reading it")
                    if isinstance(found, ReadsPort)
                    else found
                )
            case ir.IfElse():
                return _of_alternatives(map(self.of, (action.then, action.otherwise)), action.span)
            case ir.CatchException() | ir.InterruptOn():
                return self.of(action.body)
            case _:
                assert_never(action)

    def _first(self, steps: tuple[ir.CoreAction, ...]) -> Beginning:
        for step in steps:
            found = self.of(step)
            if not isinstance(found, NeverWaits):
                return found
        return _NEVER_WAITS

    def _branch(self, branch: ir.Branch[ir.CoreAction]) -> Beginning:
        match branch.event:
            case ir.ReadyEvent() | ir.InputEvent() as event if end_key(event.source) == self.key:
                return _READS_PORT
            case ir.SkipEvent():
                return self.of(branch.body)
            case ir.ReadyEvent() | ir.InputEvent() | ir.OutputEvent() | ir.AfterEvent():
                return WaitsFirst(branch.span, "the branch may choose something else first")
            case _:
                assert_never(branch.event)

    def _read(self, key: Key, span: Span) -> Beginning:
        if key == self.key:
            return _READS_PORT
        waits = read_may_wait(self.placed, key) and not is_open(self.placed, key)
        return WaitsFirst(span, f"the branch reads `{key}` first") if waits else _NEVER_WAITS

    def _law(self, instance: InstanceShape, span: Span) -> Beginning:
        keys = [key for key in inputs_of(instance) if key is not None]
        reads = self.key in keys
        for key in keys:
            if key == self.key or is_open(self.placed, key) or not read_may_wait(self.placed, key):
                continue
            if not (reads and self._is_companion(key)):
                if reads:
                    return WaitsFirst(span, f"`{instance.name}` also reads `{key}`, which may not be ready", key)
                return WaitsFirst(span, f"`{instance.name}` reads `{key}` first")
        if reads:
            return _READS_PORT
        outputs = (
            attached_key(a) for e, a in instance.attachments.items() if instance.shape.ports[e[0]].direction == "out"
        )
        for output in outputs:
            if output is not None and not is_open(self.placed, output) and write_may_wait(self.placed, output):
                return WaitsFirst(span, f"`{instance.name}` writes `{output}` first")
        return _NEVER_WAITS

    def _is_companion(self, key: Key) -> bool:
        """Whether ``key`` is a sampled input that is ready whenever the guard's port is: with the same sample instants,
        and only read together with it.
        """
        assert self.key is not None
        (kind, samples), (guard_kind, guard_samples) = self.placed.facts[key], self.placed.facts[self.key]
        is_known = UNKNOWN_SAMPLING not in (samples, guard_samples)
        if kind != "sampled" or guard_kind != "sampled" or (is_known and samples != guard_samples):
            return False
        shape = self.placed.shape
        for instance in shape.instances.values():
            keys = set(inputs_of(instance))
            if key in keys and not (instance.shape.is_submodel and self.key in keys):
                return False
        assert shape.body is not None
        return not any(isinstance(a, ir.ReadValue) and end_key(a.source) == key for a in all_actions(shape.body))

    def _process(self, instance: InstanceShape, action: ir.RunInstance) -> Beginning:
        body = instance.shape.body
        if body is None or instance.shape.incomplete or self.depth >= _LARGEST_DEPTH:
            return _READS_PORT
        inside = self.placed.inside[instance.name]
        ports = [
            element_name(*element)
            for element, attached in instance.attachments.items()
            if self.key is not None and attached_key(attached) == self.key
        ]
        found = _Beginnings(inside, ports[0] if ports else None, self.depth + 1).of(body)
        if isinstance(found, WaitsFirst):
            return WaitsFirst(action.span, found.what.replace("the branch", f"`{instance.name}`", 1))
        return found


def _of_parallel(found: Iterable[Beginning]) -> Beginning:
    """All branches begin at once, so it is enough if one of them reads the port."""
    all_found = list(found)
    if any(isinstance(one, ReadsPort) for one in all_found):
        return _READS_PORT
    return next((one for one in all_found if isinstance(one, WaitsFirst)), _NEVER_WAITS)


def _of_alternatives(found: Iterable[Beginning], span: Span) -> Beginning:
    """Every path has to read the port."""
    all_found = list(found)
    other = next((one for one in all_found if isinstance(one, WaitsFirst)), None)
    if other is not None:
        return other
    if all(isinstance(one, ReadsPort) for one in all_found):
        return _READS_PORT
    if any(isinstance(one, ReadsPort) for one in all_found):
        return WaitsFirst(span, "the branch may end without reading it")
    return _NEVER_WAITS
