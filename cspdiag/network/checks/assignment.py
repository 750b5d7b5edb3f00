"""Definite assignment: no variable is read before it has been written, and no part is unreachable.

A part that may be abandoned (``interrupt``, ``catch``) is assumed to have ended: how far it got cannot be known. A
variable that parallel branches share is reported as a race.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Set
from functools import cached_property, reduce
from operator import or_

from cspdiag.base import Report, Span
from cspdiag.base.record import record
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.composition.runs import ReadBeforeWrite, Unreachable
from cspdiag.network.flow.code import Call, Code, Instruction
from cspdiag.network.flow.effects import reads, writes
from cspdiag.network.flow.written import surely_written
from cspdiag.network.ir.actions import Target
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.network import Direction
from cspdiag.network.relations import UsesByKey, end_key
from cspdiag.network.shapes import InstanceShape, Key, PortElement, Shape, attached_key


class Flow:
    """What a run of a shape reads and writes, seen from outside.

    ``reads``: inputs that it reads. ``ends``: whether it can end. Which outputs have certainly been written, and when,
    is found when it is asked for: only what is connected to variables depends on that, and there may be as many outputs
    as there are instructions.
    """

    def __init__(self, reads: Set[Key], ends: bool, process: _Process | None = None) -> None:
        self.reads = reads
        self.ends = ends
        self._process = process
        """None if it is taken to write everything, after it has read everything."""

    def writes(self, output: Key) -> bool:
        """Whether an output has certainly been written when the run ends."""
        return self._process is None or output in self._written.at_end

    def reads_before(self, input_: Key, outputs: Collection[Key]) -> bool:
        """Whether it may read an input before it has written any of these outputs."""
        return self._process is None or self._written.before[input_].isdisjoint(outputs)

    @cached_property
    def _written(self) -> _WrittenOutputs:
        assert self._process is not None
        return self._process.written_outputs(self.reads)


@record
class _WrittenOutputs:
    """The outputs that a run of a shape has certainly written when it reads each input, and when it ends."""

    before: Mapping[Key, Set[Key]]
    at_end: Set[Key]


def check_assignment(
    shape: Shape, uses: UsesByKey, inside: Mapping[Shape, Flow], report: Report, agreement: Agreement
) -> Flow:
    """Report reads before writes, and find unreachable parts of a shape; ``inside`` gives the flows of its process
    instances.
    """
    inputs = {key for port, _, key in shape.port_elements() if port.direction == "in"}
    if shape.is_submodel or shape.is_external:
        return Flow(reads=inputs, ends=True)
    if shape.body is None or shape.incomplete:
        return Flow(reads=frozenset(), ends=True)
    process = _Process(shape, inside)
    code = shape.flow
    before = surely_written(code, process.written_by, endless=process.endless, completes=True)
    _check_reached(code, before, agreement)
    if not inputs and not process.bits:
        return Flow(reads=frozenset(), ends=before[-1] is not None, process=process)
    found: set[Key] = set()
    for instruction, written in zip(code.instructions, before, strict=True):
        if written is None:
            continue
        for key, span in process.elements_written_by(instruction):
            if not written & process.bits.get(key, 0):
                _check_read(shape, uses, key, span, "", report, is_element=True)
        for key, span, reader in process.read_by(instruction):
            if key in inputs:
                found.add(key)
            elif not written & process.bits.get(key, 0):
                _check_read(shape, uses, key, span, reader, report)
    return Flow(reads=found, ends=before[-1] is not None, process=process)


class _Process:
    """What the instructions of a shape read and write: ports, and variables that have no value at the beginning."""

    def __init__(self, shape: Shape, inside: Mapping[Shape, Flow]) -> None:
        unset = (c.name for c in shape.channels.values() if c.kind == "var" and c.initial is None and not c.excused)
        self.bits = {name: 1 << number for number, name in enumerate(unset)}
        """Those that are followed."""
        self.shape = shape
        self.inside = inside
        self.instances = shape.instances
        self._ports: dict[tuple[Shape, Direction], list[tuple[PortElement, Key]]] = {}
        self.endless = {
            name for name, instance in shape.instances.items() if (flow := inside.get(instance.shape)) and not flow.ends
        }

    def written_outputs(self, inputs: Set[Key]) -> _WrittenOutputs:
        """Which outputs are certainly written when, followed in place of the variables."""
        outputs = [key for port, _, key in self.shape.port_elements() if port.direction == "out"]
        self.bits = {key: 1 << number for number, key in enumerate(outputs)}
        code = self.shape.flow
        before = surely_written(code, self.written_by, endless=self.endless, completes=True)
        found: dict[Key, int] = {}
        for instruction, written in zip(code.instructions, before, strict=True):
            for key, _, _ in self.read_by(instruction) if written is not None else ():
                assert written is not None
                if key in inputs:
                    found[key] = found.get(key, written) & written
        at_end = before[-1]
        everything = at_end is None or self.shape.has_unknown_uses
        return _WrittenOutputs(
            {key: {output for output, bit in self.bits.items() if written & bit} for key, written in found.items()},
            {output for output, bit in self.bits.items() if everything or (at_end or 0) & bit},
        )

    def written_by(self, instruction: Instruction) -> int:
        """The bits that an instruction writes. An element of an array counts as the whole array, because indexes are
        unknown.
        """
        if not self.bits:
            return 0
        if isinstance(instruction, Call):
            keys = self._written_by_instance(self.instances[instruction.step.instance])
        else:
            keys = (to.channel if isinstance(to, Target) else end_key(to) for to in writes(instruction))
        return reduce(or_, (self.bits.get(key, 0) for key in keys), 0)

    def elements_written_by(self, instruction: Instruction) -> Iterator[tuple[Key, Span]]:
        """The arrays of which an instruction writes an element, which requires that the others have values."""
        for to in () if isinstance(instruction, Call) else writes(instruction):
            if isinstance(to, Target) and to.indexes:
                yield to.channel, instruction.span

    def read_by(self, instruction: Instruction) -> Iterator[tuple[Key, Span, str]]:
        """The reads of an instruction, each with its place and with the instance that reads, if there is one."""
        if isinstance(instruction, Call):
            instance = self.instances[instruction.step.instance]
            yield from ((key, instruction.span, instance.name) for key in self._read_by_instance(instance))
            return
        for read in reads(instruction):
            if isinstance(read, VariableValue):
                assert read.span is not None
                yield read.channel, read.span, ""
            else:
                yield end_key(read), instruction.span, ""

    def _written_by_instance(self, instance: InstanceShape) -> Iterator[Key]:
        flow = self.inside.get(instance.shape)
        for key, outer in self._attached(instance, "out"):
            if outer in self.bits and (flow is None or flow.writes(key)):
                yield outer

    def _read_by_instance(self, instance: InstanceShape) -> Iterator[Key]:
        """The reads of an instance, except of what it has written itself before."""
        flow = self.inside.get(instance.shape)
        outputs: dict[Key, list[Key]] = {}
        if flow is not None:
            for key, outer in self._attached(instance, "out"):
                outputs.setdefault(outer, []).append(key)
        for key, outer in self._attached(instance, "in"):
            if flow is None or (key in flow.reads and (outer not in outputs or flow.reads_before(key, outputs[outer]))):
                yield outer

    def _attached(self, instance: InstanceShape, direction: Direction) -> Iterator[tuple[Key, Key]]:
        """The ports of an instance in one direction, each with the port or channel of the process that it is attached
        to.
        """
        shape = instance.shape
        ports = self._ports.get((shape, direction))
        if ports is None:
            ports = [(element, key) for port, element, key in shape.port_elements() if port.direction == direction]
            self._ports[shape, direction] = ports
        for element, key in ports:
            attached = instance.attachments.get(element)
            outer = None if attached is None else attached_key(attached)
            if outer is not None:
                yield key, outer


def _check_reached(code: Code, before: list[int | None], agreement: Agreement) -> None:
    for sequence, starts in code.sequences:
        for position, step in enumerate(sequence.steps):
            if before[starts[position]] is None:
                if position > 0:
                    agreement.claim(Unreachable(span=step.span, endless=sequence.steps[position - 1].span))
                break
            agreement.refute(Unreachable, step.span)


def _check_read(
    shape: Shape, uses: UsesByKey, key: Key, span: Span, reader: str, report: Report, *, is_element: bool = False
) -> None:
    """Report the first read of a variable without a value."""
    channel = shape.channels.get(key)
    if channel is None or channel.kind != "var" or channel.excused or channel.initial is not None:
        return
    channel.excused = True
    report.add(
        ReadBeforeWrite(
            span=span,
            variable=key,
            reader=reader,
            is_variable=channel.is_variable,
            is_element=is_element,
            declared=channel.span,
            writer=uses[key].writer if key in uses else None,
        )
    )
