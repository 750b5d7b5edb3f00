"""Where the transition system of a specification allows more than the specification itself: it leaves out priorities
and times that exclude some of the runs.

A process with such a run would be taken to refine the specification. What a specification itself leaves open is not
reported: which of its parallel processes continues first, which of several ready guards of ``[]`` is taken, and what
arrives from outside, and when.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Communicate, Delay, Take
from cspdiag.network.flow.waiting import is_always_ready
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import ProcessClass, SubmodelClass
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import Occurrence, World
from cspdiag.proofs.transitions.systems.system import Abstraction

_ALWAYS_READY = "always"
_INSIDE = "inside"
_SAMPLED = "sampled"
_TIMED = "timed"
_EVENT = "event"


def specification_abstractions(world: World) -> Iterator[Abstraction]:
    """What the transition system leaves out of a specification."""
    pending = [world.top]
    seen: set[tuple[str, ...]] = set()
    for occurrence in pending:
        alike = (occurrence.definition.name, *(medium.kind for medium in occurrence.ports.values()))
        if occurrence.definition.body is None or alike in seen:
            continue
        seen.add(alike)
        yield from _left_out(occurrence.definition.body, occurrence)
        for node in _inside(occurrence.definition.body):
            child = _run_by(node, occurrence)
            if child is not None:
                pending.append(child)


def _inside(node: Node) -> Iterator[Node]:
    yield node
    for child in node.children:
        yield from _inside(child)


def _run_by(node: Node, occurrence: Occurrence) -> Occurrence | None:
    """The process that an action runs, if it runs one."""
    if not isinstance(node.action, ir.RunInstance):
        return None
    instance = occurrence.definition.instances[node.action.instance]
    definition = occurrence.world.program.classes[instance.class_name].definition
    return occurrence.child(instance.name) if isinstance(definition, ProcessClass) else None


def _left_out(root: Node, occurrence: Occurrence) -> Iterator[Abstraction]:
    where = occurrence.definition.name
    for node in _inside(root):
        match node.action:
            case ir.ParallelSteps(prioritized=True):
                yield Abstraction(f"the priorities of `||>` in `{where}` are left out", node.span)
            case ir.ParallelSteps() if _compete(node, occurrence):
                yield Abstraction(
                    f"when the parallel parts of `{where}` reach their delays and samples is left out", node.span
                )
            case ir.Choice() as choice:
                kinds = _kinds(choice, occurrence)
                if choice.prioritized and not _in_order(kinds):
                    yield Abstraction(f"which guard of `[]>` in `{where}` comes first is left out", node.span)
                if _TIMED in kinds and (kinds.count(_TIMED) > 1 or not {_EVENT, _TIMED}.issuperset(kinds)):
                    yield Abstraction(f"which guard in `{where}` is ready first in time is left out", node.span)
                elif kinds.count(_SAMPLED) > 1:
                    yield Abstraction(f"in which order samples come in `{where}` is left out", node.span)
            case ir.InterruptOn() as interrupt if _kind(interrupt.branch, occurrence) != _EVENT:
                yield Abstraction(f"when the interrupt in `{where}` comes is left out", node.span)
            case (
                ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.StopStep()
                | ir.WaitStep() | ir.ResetInstance() | ir.RaiseException() | ir.SequentialSteps() | ir.ParallelSteps()
                | ir.Repeat() | ir.WhileLoop() | ir.CountedLoop() | ir.IfElse() | ir.CatchException() | ir.InterruptOn()
                | ir.Group()
            ):  # fmt: skip
                pass
            case _:
                assert_never(node.action)


def _in_order(kinds: list[str]) -> bool:
    """Whether the order of priority excludes no guard that the transition system takes: an event from outside may
    arrive at any time, and the guards after one that is always ready are left out there, too.
    """
    if _ALWAYS_READY in kinds:
        return {_EVENT}.issuperset(kinds[: kinds.index(_ALWAYS_READY)])
    others = [kind for kind in kinds if kind != _EVENT]
    return not others or (len(others) == 1 and (others[0] != _INSIDE or kinds[-1] == _INSIDE))


def _kinds(choice: ir.Choice, occurrence: Occurrence) -> list[str]:
    """The kinds of the guards, without time-outs that never happen because another guard is always ready."""
    kinds = [_kind(branch, occurrence) for branch in choice.branches]
    if _ALWAYS_READY not in kinds:
        return kinds
    return [kind for kind, branch in zip(kinds, choice.branches, strict=True) if not is_time_out(branch)]


def is_time_out(branch: ir.Branch) -> bool:
    """Whether a guard waits for a duration that is known and longer than zero."""
    event = branch.event
    if not isinstance(event, ir.AfterEvent) or not isinstance(event.duration, LiteralValue):
        return False
    return isinstance(event.duration.value, int) and event.duration.value > 0


def _kind(branch: ir.Branch, occurrence: Occurrence) -> str:
    """What decides when a guard is ready."""
    if is_always_ready(branch.event, lambda end: occurrence.attached(end).kind):
        return _ALWAYS_READY
    match branch.event:
        case ir.AfterEvent():
            return _TIMED
        case ir.SkipEvent() | ir.OutputEvent():
            return _INSIDE
        case ir.InputEvent(source=source) | ir.ReadyEvent(source=source):
            medium = occurrence.attached(source)
            if medium.kind == "event" and not medium.is_contended:
                return _EVENT
            return _SAMPLED if medium.kind == "sampled" else _INSIDE


def _compete(parallel: Node, occurrence: Occurrence) -> bool:
    """Whether times decide which of the branches comes first: two of them read samples, or one waits for delays."""
    found = [_times_in(child, occurrence) for child in parallel.children]
    return len(found) > 1 and (any(_TIMED in times for times in found) or sum(map(bool, found)) > 1)


def _times_in(root: Node, occurrence: Occurrence) -> set[str]:
    found: set[str] = set()
    for instruction in flow_of(root.action).instructions:
        match instruction:
            case Delay():
                found.add(_TIMED)
            case Communicate(step=ir.ReadValue(source=source)) if occurrence.attached(source).kind == "sampled":
                found.add(_SAMPLED)
            case Take(branch=branch):
                found |= {_kind(branch, occurrence)} & {_TIMED, _SAMPLED}
            case Call(step=step):
                found |= _times_of(step.instance, occurrence)
            case _:  # Nothing else waits for a time or a sample.
                pass
    return found


def _times_of(name: str, occurrence: Occurrence) -> set[str]:
    instance = occurrence.definition.instances[name]
    definition = occurrence.world.program.classes[instance.class_name].definition
    if isinstance(definition, SubmodelClass):
        media = (occurrence.attached(connection.attachment) for connection in instance.connections)
        return {_SAMPLED for medium in media if medium.kind == "sampled"}
    child = occurrence.child(name)
    return set() if child.definition.body is None else _times_in(child.definition.body, child)
