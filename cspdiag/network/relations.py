"""Which parts of a program use a channel, and whether they are in sequence or in parallel.

One walk up the composition gives, for every port and channel of a shape, one witness pair of each relation that occurs.
Branches of a parallel are in parallel with each other; everything else (``;``, loops, branches of an alternative) is in
sequence. An instance contributes the pairs inside it, so the relations of a net are those of its leaves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import Slotted, record
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression, VariableValue
from cspdiag.network.ir.walk import parts
from cspdiag.network.shapes import InstanceShape, Key, Shape, attached_key, element_name


@record
class Access(Slotted):
    """One use of a channel as the diagram shows it: by an instance, or by the process itself (then ``instance`` is
    empty).

    ``span`` is the end of the relationship, or the communication; ``run`` is where in the composition the use happens.
    """

    span: Span
    run: Span
    instance: str
    own_end: bool = False
    """Whether it has a reading end of its own, as an instance of a process does."""

    @property
    def user(self) -> str:
        """Words for the user of the channel."""
        return f"`{self.instance}`" if self.instance else "the process itself"


Pair: TypeAlias = "tuple[Access, Access]"


class Uses:
    """The uses of one port or channel: a writer, a reader, and a pair for each relation between two of them."""

    __slots__ = (
        "observer",
        "parallel",
        "parallel_observation",
        "parallel_reads",
        "parallel_writes",
        "reader",
        "sequential",
        "sequential_reads",
        "writer",
    )

    def __init__(
        self, writer: Access | None = None, reader: Access | None = None, observer: Access | None = None
    ) -> None:
        self.writer = writer
        self.reader = reader
        self.observer = observer
        """An expression of the process itself that mentions the label of an arrow; it is not a communication, and does
        not affect the kind.
        """
        self.parallel_observation: Pair | None = None
        """A writer and a observer in parallel."""
        self.parallel: Pair | None = None
        """A writer and a reader in parallel."""
        self.sequential: Pair | None = None
        """A writer and a reader in sequence."""
        self.parallel_writes: Pair | None = None
        self.parallel_reads: Pair | None = None
        self.sequential_reads: Pair | None = None
        """Two readers in sequence that are different processes, each with a reading end of its own."""

    def join(self, other: Uses, parallel: bool) -> None:
        """Adds the uses of another part of the composition."""
        crossing = [(self.writer, other.reader), (other.writer, self.reader)]
        for writer, reader in crossing:
            if writer is not None and reader is not None:
                if parallel:
                    self.parallel = self.parallel or (writer, reader)
                else:
                    self.sequential = self.sequential or (writer, reader)
        for writer, observer in ((self.writer, other.observer), (other.writer, self.observer)):
            if writer is not None and observer is not None and parallel:
                self.parallel_observation = self.parallel_observation or (writer, observer)
        if self.writer is not None and other.writer is not None and parallel:
            self.parallel_writes = self.parallel_writes or (self.writer, other.writer)
        if self.reader is not None and other.reader is not None:
            if parallel:
                self.parallel_reads = self.parallel_reads or (self.reader, other.reader)
            elif self.reader.instance != other.reader.instance and (self.reader.own_end or other.reader.own_end):
                self.sequential_reads = self.sequential_reads or (self.reader, other.reader)
        self.writer = self.writer or other.writer
        self.reader = self.reader or other.reader
        self.observer = self.observer or other.observer
        self.parallel_observation = self.parallel_observation or other.parallel_observation
        self.parallel = self.parallel or other.parallel
        self.sequential = self.sequential or other.sequential
        self.parallel_writes = self.parallel_writes or other.parallel_writes
        self.parallel_reads = self.parallel_reads or other.parallel_reads
        self.sequential_reads = self.sequential_reads or other.sequential_reads


UsesByKey: TypeAlias = "dict[Key, Uses]"
Groups: TypeAlias = "tuple[tuple[Key, ...], ...]"
"""Groups of ports of an instance that are attached to the same channel of the enclosing process."""


def run_key(instance: str) -> Key:
    """The key under which runs and resets of an instance are counted as writes; no name of the text has a space."""
    return f"run {instance}"


class Relations:
    """The uses in every shape, shapes of instances before those that contain them."""

    def __init__(self) -> None:
        self._known: dict[tuple[Shape, Groups], UsesByKey] = {}

    def of(self, shape: Shape, groups: Groups = ()) -> UsesByKey:
        """The uses of every port and channel; ports of a group are counted under the first of the group."""
        known = self._known.get((shape, groups))
        if known is None:
            known = self._known[shape, groups] = _Walk(self, shape, groups).result()
        return known


class _Walk:
    def __init__(self, relations: Relations, shape: Shape, groups: Groups) -> None:
        self.relations = relations
        self.shape = shape
        self.same = {key: group[0] for group in groups for key in group}

    def result(self) -> UsesByKey:
        if self.shape.is_submodel:
            return self._submodel()
        if self.shape.body is None:
            return self._external()
        return self._action(self.shape.body)

    def _submodel(self) -> UsesByKey:
        """The uses by a submodel, which reads all inputs at once, and then writes all outputs at once."""
        reads: UsesByKey = {}
        writes: UsesByKey = {}
        for port, _, key in self.shape.port_elements():
            access = Access(port.span, port.span, "")
            if port.direction == "in":
                _put(reads, self.same.get(key, key), Uses(reader=access), parallel=True)
            else:
                _put(writes, self.same.get(key, key), Uses(writer=access), parallel=True)
        return _joined(reads, writes, parallel=False)

    def _external(self) -> UsesByKey:
        """The uses by a body in another language, which uses each port in an unknown order."""
        uses: UsesByKey = {}
        for port, _, key in self.shape.port_elements():
            access = Access(port.span, port.span, "")
            use = Uses(reader=access) if port.direction == "in" else Uses(writer=access)
            _put(uses, self.same.get(key, key), use, parallel=False)
        return uses if self.shape.is_external else {}

    def _action(self, action: ir.CoreAction) -> UsesByKey:
        match action:
            case ir.RunInstance():
                return self._run(self.shape.instances[action.instance], action.span)
            case ir.ResetInstance():
                access = Access(action.span, action.span, action.instance)
                return {run_key(action.instance): Uses(writer=access)}
            case ir.ReadValue():
                uses = self._reads(action.source, action.span)
                self._target(uses, action.target, action.span)
                return uses
            case ir.WriteValue():
                uses = self._values(action.value)
                self._put_end(uses, action.sink, Uses(writer=Access(action.span, action.span, "")))
                return uses
            case ir.AssignValue():
                uses = self._values(action.value)
                self._target(uses, action.target, action.span)
                return uses
            case ir.WaitStep():
                return self._values(action.duration)
            case ir.SkipStep() | ir.StopStep() | ir.RaiseException():
                return {}
            case ir.SequentialSteps() | ir.ParallelSteps():
                return self._fold(map(self._action, action.steps), isinstance(action, ir.ParallelSteps))
            case ir.Choice():
                return self._fold(map(self._branch, action.branches), False)
            case ir.Repeat():
                parts = [self._action(action.body)]
                if action.until is not None:
                    parts.append(self._values(action.until))
                return self._fold(parts, False)
            case ir.WhileLoop():
                return self._fold([self._values(action.condition), self._action(action.body)], False)
            case ir.IfElse():
                parts = [self._values(action.condition), self._action(action.then), self._action(action.otherwise)]
                return self._fold(parts, False)
            case ir.CatchException():
                return self._fold([self._action(action.body), self._action(action.handler)], False)
            case ir.InterruptOn():
                waiting = self._event(action.branch.event, action.branch.condition)
                both = self._fold([self._action(action.body), waiting], True)
                return self._fold([both, self._action(action.branch.body)], False)
            case ir.CountedLoop() | ir.Group():
                return self._action(action.body)
            case _:
                assert_never(action)

    def _fold(self, parts: Iterable[UsesByKey], parallel: bool) -> UsesByKey:
        whole: UsesByKey = {}
        for part in parts:
            whole = _joined(whole, part, parallel)
        return whole

    def _branch(self, branch: ir.Branch[ir.CoreAction]) -> UsesByKey:
        return self._fold([self._event(branch.event, branch.condition), self._action(branch.body)], False)

    def _event(self, event: ir.Event, condition: Expression | None) -> UsesByKey:
        uses: UsesByKey = {} if condition is None else self._values(condition)
        match event:
            case ir.ReadyEvent():
                self._put_end(uses, event.source, Uses(reader=Access(event.span, event.span, "")))
            case ir.InputEvent():
                self._put_end(uses, event.source, Uses(reader=Access(event.span, event.span, "")))
                self._target(uses, event.target, event.span)
            case ir.OutputEvent():
                uses = _joined(uses, self._values(event.value), False)
                self._put_end(uses, event.sink, Uses(writer=Access(event.span, event.span, "")))
            case ir.AfterEvent():
                uses = _joined(uses, self._values(event.duration), False)
            case ir.SkipEvent():
                pass
            case _:
                assert_never(event)
        return uses

    def _run(self, instance: InstanceShape, span: Span) -> UsesByKey:
        uses: UsesByKey = {run_key(instance.name): Uses(writer=Access(span, span, instance.name))}
        attached: dict[Key, list[Key]] = {}
        ends: dict[Key, Span] = {}
        keys = instance.shape.element_keys
        for element, attachment in instance.attachments.items():
            key = attached_key(attachment)
            if key is not None:
                attached.setdefault(key, []).append(keys[element])
                ends.setdefault(key, attachment.span)
        groups = tuple([tuple(ports) for ports in attached.values() if len(ports) > 1])
        inside = self.relations.of(instance.shape, groups)
        has_ends = not instance.shape.is_submodel
        for key, ports in attached.items():
            use = inside.get(ports[0])
            if use is not None:
                lifted = _lifted(use, Access(ends[key], span, instance.name, has_ends))
                if self.same:
                    _put(uses, self.same.get(key, key), lifted, False)
                else:
                    uses[key] = lifted
        return uses

    def _reads(self, source: ir.End, span: Span) -> UsesByKey:
        uses: UsesByKey = {}
        self._put_end(uses, source, Uses(reader=Access(span, span, "")))
        return uses

    def _put_end(self, uses: UsesByKey, end: ir.End, use: Uses) -> None:
        key = end_key(end)
        _put(uses, self.same.get(key, key), use, False)

    def _target(self, uses: UsesByKey, target: ir.Target, span: Span) -> None:
        for index in target.indexes:
            for key, use in self._values(index).items():
                _put(uses, key, use, False)
        _put(uses, target.channel, Uses(writer=Access(span, span, "")), False)

    def _values(self, expression: Expression) -> UsesByKey:
        uses: UsesByKey = {}
        for value in variables_read(expression):
            assert value.span is not None
            access = Access(value.span, value.span, "")
            is_variable = self.shape.channels[value.channel].is_variable
            _put(uses, value.channel, Uses(reader=access) if is_variable else Uses(observer=access), False)
        return uses


def end_key(end: ir.End) -> Key:
    """The key of the port or channel of an end."""
    return element_name(end.port, end.index) if isinstance(end, ir.PortEnd) else end.channel


def variables_read(item: Expression | ir.CoreAction) -> Iterator[VariableValue]:
    """The variables that an expression, or all expressions of an action, read."""
    return (part for part in parts(item) if isinstance(part, VariableValue))


def _put(uses: UsesByKey, key: Key, use: Uses, parallel: bool) -> None:
    known = uses.get(key)
    if known is None:
        uses[key] = use
    else:
        known.join(use, parallel)


def _joined(one: UsesByKey, other: UsesByKey, parallel: bool) -> UsesByKey:
    """The uses of two parts together; adds the smaller table to the larger one."""
    if len(one) < len(other):
        one, other = other, one
    for key, use in other.items():
        known = one.get(key)
        if known is None:
            one[key] = use
        else:
            known.join(use, parallel)
    return one


def _lifted(use: Uses, access: Access) -> Uses:
    """The use of a port by an instance from the point of view of the enclosing process; pairs inside the instance are
    unchanged.
    """
    lifted = Uses(access if use.writer else None, access if use.reader else None)
    lifted.parallel = use.parallel
    lifted.sequential = use.sequential
    lifted.parallel_writes = use.parallel_writes
    lifted.parallel_reads = use.parallel_reads
    lifted.sequential_reads = use.sequential_reads
    return lifted
