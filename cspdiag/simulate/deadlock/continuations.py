"""What processes may still communicate after the steps at which they wait, on any path: conditions may hold or not,
exceptions may be raised, and interrupts may happen.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Code,
    Communicate,
    Instruction,
    ProcessEnd,
    Select,
    Stop,
    Take,
    following,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import CoreNetwork, ProcessClass, SubmodelClass
from cspdiag.network.relations import end_key
from cspdiag.simulate.deadlock.waiting import Offer, WaitingRecord


@record
class Use:
    """A communication of a process, or of a control law that it runs."""

    offer: Offer
    process: str


class _Flow:
    """The control flow of a process."""

    def __init__(self, code: Code[ir.CoreAction]) -> None:
        self.instructions = code.instructions
        self.abandoned = code.abandoned
        self.following = [
            [way for way in ways if way not in code.waiting]  # A parallel of which some branch never ends does not end.
            for ways in following(code)
        ]

    def reached(self, starts: Iterable[int]) -> list[int]:
        """The instructions that may be executed from ``starts`` on."""
        found: dict[int, None] = {}
        pending = list(starts)
        while pending:
            index = pending.pop()
            if index not in found:
                found[index] = None
                pending += [*self.following[index], *self.when_abandoned(index)]
        return list(found)

    def after(self, index: int) -> list[int]:
        """Where a process continues that waits at an instruction."""
        starts = self.following[index]
        if isinstance(self.instructions[index], Select):
            starts = [after for take in starts for after in self.following[take]]
        return [*starts, *self.when_abandoned(index)]

    def when_abandoned(self, index: int) -> list[int]:
        """Where a process continues if it is abandoned at an instruction."""
        target = self.abandoned[index]
        return [] if target is None else [target]

    def waiting(self) -> Iterator[int]:
        """The instructions at which the process may wait for partners."""
        for index, instruction in enumerate(self.instructions):
            # The guard of an interrupt waits by itself if its partner was faster taken by another process.
            if isinstance(instruction, Communicate | Select | Stop | Call) or (
                isinstance(instruction, Take) and isinstance(self.instructions[index - 1], Abandon)
            ):
                yield index


class Continuations:
    """What the processes of a network may still communicate."""

    def __init__(self, network: CoreNetwork) -> None:
        self._network = network
        self._flows: dict[str, _Flow] = {}
        self._ended: dict[tuple[str, bool], frozenset[Use]] = {}

    def of(self, record: WaitingRecord) -> frozenset[Use]:
        """The communications that a waiting process offers, and those that may follow them."""
        now = frozenset(Use(offer, self.process_of(record.path)) for offer in record.offers)
        return now | self._after(record)

    def process_of(self, path: str) -> str:
        """The process that runs the control law of this path; the path itself if it is that of a process."""
        return _enclosing(path) if isinstance(self._classes.get(path), SubmodelClass) else path

    def _after(self, record: WaitingRecord) -> frozenset[Use]:
        match self._classes.get(record.path):
            case ProcessClass(body=body) if body is not None:
                flow = self._flow(record.path)
                places = self._places(flow, record)
                starts = [start for place in places for start in flow.after(place)] if places else [0]
                laws = (flow.instructions[place] for place in places)
                results = [self._results(f"{record.path}.{law.step.instance}") for law in laws if isinstance(law, Call)]
                return self._from(record.path, starts).union(*results)
            case SubmodelClass():
                # It reads all its inputs before it writes.
                reads = any(offer.side == "read" for offer in record.offers)
                results = [self._results(record.path)] if reads else []
                return self._after_end(record.path, ends=True).union(*results)
            case ProcessClass():
                return self._within.get(record.path, frozenset()) | self._after_end(record.path, ends=True)
            case None:
                return self._within[self._network.top]

    def _places(self, flow: _Flow, record: WaitingRecord) -> list[int]:
        """The instructions at which the process may wait: those that do what it waits for on the line that it reports
        or, if there are none, on any line.
        """
        fitting = [index for index in flow.waiting() if self._fits(record.path, flow.instructions[index], record)]
        there = [index for index in fitting if flow.instructions[index].span.line == record.line]
        return there or fitting

    def _fits(self, path: str, instruction: Instruction, record: WaitingRecord) -> bool:
        offers = record.offers
        match instruction:
            case Stop():
                return not offers and record.waits.startswith("forever")
            case Select():
                branches = instruction.step.branches
                own = {use.offer for branch in branches for use in self._uses_of_event(path, branch.event)}
                return offers <= own and (bool(offers) or record.waits.startswith("for an alternative"))
            case Call():
                law = f"{path}.{instruction.step.instance}"
                own = {use.offer for use in self._within.get(law, ())}
                return bool(offers) and isinstance(self._classes.get(law), SubmodelClass) and offers <= own
            case _:  # Any other instruction communicates once, or does not wait.
                return bool(offers) and offers == {use.offer for use in self._uses(path, instruction)}

    def _from(self, path: str, starts: Iterable[int]) -> frozenset[Use]:
        """The communications from some instructions of a process on, those after its end included."""
        flow = self._flow(path)
        reached = [flow.instructions[index] for index in flow.reached(starts)]
        ends = any(isinstance(instruction, ProcessEnd) for instruction in reached)
        uses = frozenset(use for instruction in reached for use in self._uses(path, instruction))
        return uses | self._after_end(path, ends=ends)

    def _after_end(self, path: str, *, ends: bool) -> frozenset[Use]:
        """The communications of the enclosing processes after a process has ended by itself, if it ``ends``, or has
        been abandoned.
        """
        known = self._ended.get((path, ends))
        if known is None:
            known = self._ended[path, ends] = frozenset(self._found_after_end(path, ends=ends))
        return known

    def _found_after_end(self, path: str, *, ends: bool) -> frozenset[Use]:
        enclosing, _, name = path.rpartition(".")
        if not enclosing:
            return frozenset()
        flow = self._flow(enclosing)
        starts: list[int] = []
        for index, instruction in enumerate(flow.instructions):
            if isinstance(instruction, Call) and instruction.step.instance == name:
                starts += flow.after(index) if ends else flow.when_abandoned(index)
        return self._from(enclosing, starts)

    def _uses(self, path: str, instruction: Instruction) -> Iterator[Use]:
        match instruction:
            case Communicate(step=ir.ReadValue(source=source)):
                yield from self._uses_of_end(path, source, "read")
            case Communicate(step=ir.WriteValue(sink=sink)):
                yield from self._uses_of_end(path, sink, "write")
            case Take():
                yield from self._uses_of_event(path, instruction.branch.event)
            case Call():
                yield from self._within.get(f"{path}.{instruction.step.instance}", ())
            case _:  # No other instruction communicates.
                pass

    def _uses_of_event(self, path: str, event: ir.Event) -> Iterator[Use]:
        match event:
            case ir.InputEvent(source=source) | ir.ReadyEvent(source=source):
                yield from self._uses_of_end(path, source, "read")
            case ir.OutputEvent(sink=sink):
                yield from self._uses_of_end(path, sink, "write")
            case ir.AfterEvent() | ir.SkipEvent():
                pass

    def _uses_of_end(self, path: str, end: ir.End, side: str) -> Iterator[Use]:
        return (use for use in self._by_end.get((path, end_key(end)), ()) if use.offer.side == side)

    def _results(self, law: str) -> frozenset[Use]:
        """What a control law writes."""
        return frozenset(use for use in self._within.get(law, ()) if use.offer.side == "write")

    def _flow(self, path: str) -> _Flow:
        entry = self._classes[path]
        found = self._flows.get(entry.name)
        if found is None:
            assert isinstance(entry, ProcessClass)
            assert entry.body is not None
            found = self._flows[entry.name] = _Flow(flow_of(entry.body))
        return found

    @cached_property
    def _classes(self) -> dict[str, ProcessClass[ir.CoreAction] | SubmodelClass]:
        classes = {entry.name: entry for entry in self._network.classes}
        return {item.path: classes[item.class_name] for item in self._network.instances}

    @cached_property
    def _by_end(self) -> dict[tuple[str, str], list[Use]]:
        """The communications through each port or channel of a process or control law, by its path."""
        found: defaultdict[tuple[str, str], list[Use]] = defaultdict(list)
        for net in self._network.nets:
            for side, users in (("read", net.readers), ("write", net.writers)):
                for path, key in users:
                    found[path, key].append(Use(Offer(net.path, side), self.process_of(path)))
        return found

    @cached_property
    def _within(self) -> dict[str, frozenset[Use]]:
        """The communications of each process with all that it consists of."""
        found: defaultdict[str, set[Use]] = defaultdict(set)
        for (path, _), uses in self._by_end.items():
            while path:
                found[path].update(uses)
                path = _enclosing(path)
        return {path: frozenset(uses) for path, uses in found.items()}


def _enclosing(path: str) -> str:
    return path.rpartition(".")[0]
