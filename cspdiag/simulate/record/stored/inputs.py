"""Inputs from a recording: what a recorded run was given, for a run of the same program or of another one with the same
ports, instead of what its environment computes.

A sample is given at its tick. An event was recorded when it was taken; it is offered at the last instant of the grid
until then, so it is taken at the same instant again.
"""

from __future__ import annotations

from collections.abc import Iterator
from heapq import merge
from operator import itemgetter
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.base.record import record, replaced
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import CoreNetwork, Environment, ExternalPort, SubmodelClass
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.network.lower.environments import grid_of, opposite_port
from cspdiag.runtime.kernel.durations import shown
from cspdiag.simulate.record.stored.described import RecordedPort, head_of
from cspdiag.simulate.record.stored.fitting import NoValueError, fitted
from cspdiag.simulate.record.stored.parameters import recorded_changes
from cspdiag.simulate.record.stored.recording import InputsError, StoredRecording, plain

if TYPE_CHECKING:
    import numpy

    from cspdiag.runtime.kernel.parameters import Change as ParameterChange

ENVIRONMENT = "Recorded"
"""The name of the environment of a program without one."""

Change = tuple[int, int, Any]
"""An instant in nanoseconds, the position of the input, its value from then on."""


@record
class RecordedInputs:
    """The inputs of a program from a recording that fits them. ``positions`` are those of the inputs among the external
    ports; ``initial`` their values at time 0. ``parameter_changes`` are those with which the parameters of the program
    are those of the recorded run.
    """

    recording: StoredRecording
    ports: tuple[ExternalPort, ...]
    positions: tuple[int, ...]
    step: int
    initial: tuple[Any, ...]
    parameter_changes: tuple[ParameterChange, ...] = ()

    __hash__ = object.__hash__

    @property
    def end(self) -> int:
        """The instant in nanoseconds up to which the recording has inputs."""
        return self.recording.time

    def changes(self) -> Iterator[Change]:
        """What the inputs are given, in order of time."""
        return merge(*(self._of(index) for index in range(len(self.ports))), key=itemgetter(0))

    def _as_values(self, values: numpy.ndarray, port: ExternalPort) -> numpy.ndarray:
        return values if self.recording.typed else fitted(values, port.name, port.type)

    def _of(self, index: int) -> Iterator[Change]:
        port = self.ports[index]
        name = [known.name for known in self.recording.head.ports].index(port.name)
        last = self.initial[index]
        for blocks in self.recording.blocks((name,)):
            for block in blocks:
                for time, value in zip(block.time.tolist(), plain(self._as_values(block.value, port)), strict=True):
                    if port.sampling is not None:
                        yield time, index, value
                        continue
                    offered = time // self.step * self.step
                    if value == last and port.kind != "broadcast":
                        # In between there was another value, which nobody took.
                        yield offered - self.step, index, another(value, port.type)
                    if value != last or port.kind != "broadcast":
                        yield offered, index, value
                    last = value


def with_environment(network: CoreNetwork) -> CoreNetwork:
    """The network with an environment in which a recording can take the place of one, if the program has ports and no
    environment. Its grid is that of an environment without ``step``.
    """
    if network.environments or not network.external_ports:
        return network
    top = network.class_named(network.top)
    taken = {*network.exceptions, *(item.name for item in (*network.classes, *network.enums, *network.structs))}
    name = DistinctNames(taken).fresh(ENVIRONMENT, lambda number: f"{ENVIRONMENT}_{number}")
    own: dict[str, Any] = {"name": name, "doc": None, "span": top.span}
    system = SubmodelClass(
        definition=name,
        ports=tuple(opposite_port(port) for port in network.external_ports),
        equations=tuple(
            SubmodelEquation(
                name=port.name,
                type=port.type,
                value=LiteralValue(type=port.type, value=_of_literal(_zero(port.type))),
                span=port.span,
            )
            for port in network.external_ports
            if port.direction == "in"
        ),
        **own,
    )
    step = grid_of(network.external_ports)
    return replaced(network, environments=(Environment(system=system, drivers=(), step=step, **own),))


def _of_literal(value: Any) -> Any:
    return tuple(map(_of_literal, value)) if isinstance(value, list) else value


def recorded_inputs(network: CoreNetwork, environment: Environment, recording: StoredRecording) -> RecordedInputs:
    """The inputs of the program from a recording. Raises InputsError, and RecordingError."""
    known = {port.name: port for port in recording.head.ports}
    positions, initial, count = [], [], 0
    for position, (port, wanted) in enumerate(
        zip(network.external_ports, head_of(network, environment).ports, strict=True)
    ):
        if port.direction == "out":
            continue
        where = f"`{port.name}` ({port.span.source.name}:{port.span.line})"
        found = known.get(port.name)
        if found is None:
            names = ", ".join(recording.columns or known) or "none"
            raise InputsError(f"{recording.path} has no signal for the input {where}; it has: {names}")
        if recording.typed:
            _require_same(recording, found, wanted, where)
        elif not _may_be(found.type, wanted.type):
            raise InputsError(
                f"{recording.path}: {found.name} is a {found.type}, and the input {where} a {wanted.type}"
            )
        times, values = recording.values(port.name)
        if not recording.typed:
            values = _fitted(recording, times, values, port)
        count += len(times)
        if wanted.period:
            _require_ticks(recording, times, wanted, where)
        positions.append(position)
        events = plain(values[:1])
        initial.append(another(events[0], port.type) if events else _zero(port.type))
    if positions and not count and not recording.typed:
        raise InputsError(f"{recording.path} has no values")
    inputs = tuple(network.external_ports[position] for position in positions)
    changes = recorded_changes(network, recording)
    return RecordedInputs(recording, inputs, tuple(positions), environment.step, tuple(initial), changes)


def _require_same(recording: StoredRecording, found: RecordedPort, wanted: RecordedPort, where: str) -> None:
    if found.type != wanted.type:
        raise InputsError(f"{recording.path}: {found.name} is a {found.type}, and the input {where} a {wanted.type}")
    if found.direction != "in":
        raise InputsError(f"{recording.path}: {found.name} is an output, and {where} an input")
    if (found.period, found.offset) != (wanted.period, wanted.offset):
        raise InputsError(
            f"{recording.path}: {found.name} has {_rhythm(found)}, and the input {where} {_rhythm(wanted)}"
        )


def _fitted(
    recording: StoredRecording, times: numpy.ndarray, values: numpy.ndarray, port: ExternalPort
) -> numpy.ndarray:
    try:
        return fitted(values, port.name, port.type)
    except NoValueError as problem:
        raise InputsError(
            f"{recording.path}: {problem.name} at {shown(int(times[problem.position]))}: {problem}"
        ) from None


def _may_be(found: Type, wanted: Type) -> bool:
    """Whether numbers of another program, which have no units and no literals, can be values of an input."""
    match wanted:
        case ArrayType(element=element, size=size):
            return isinstance(found, ArrayType) and found.size == size and _may_be(found.element, element)
        case RealType():
            return isinstance(found, RealType | IntType)
        case IntType() | TimeType():
            return isinstance(found, IntType | TimeType)
        case EnumType():
            return isinstance(found, IntType | EnumType)
        case BoolType() | StructType() | TextType() | UnknownType():
            return type(found) is type(wanted)
        case _:
            assert_never(wanted)


def _rhythm(port: RecordedPort) -> str:
    if not port.period:
        return "events"
    return f"a sample every {shown(port.period)}" + (f", offset {shown(port.offset)}" if port.offset else "")


def _require_ticks(recording: StoredRecording, times: numpy.ndarray, port: RecordedPort, where: str) -> None:
    """There is a sample for each tick until the end of the recording."""
    import numpy

    first = port.offset or port.period
    count = max(0, (recording.time - first) // port.period + 1)
    expected = first + numpy.arange(count) * port.period
    own = times[: len(expected)]
    if len(own) < len(expected) - 1 or not numpy.array_equal(own, expected[: len(own)]):
        wrong = numpy.flatnonzero(own != expected[: len(own)])
        at = int(expected[wrong[0]]) if len(wrong) else int(expected[len(own)])
        if len(wrong) and own[wrong[0]] < at:
            there = shown(int(own[wrong[0]]))
            raise InputsError(
                f"{recording.path} has a value at {there} for the input {where}, which has {_rhythm(port)}, not then"
            )
        raise InputsError(f"{recording.path} has no sample at {shown(at)} for the input {where}, {_rhythm(port)}")


def like(example: Any, value: Any) -> Any:
    """A plain value as the program has it: ``example`` is one of its values."""
    if not isinstance(value, list):
        return type(example)(value)
    parts = [like(example[at], part) for at, part in enumerate(value)]
    return tuple(parts) if type(example) is tuple else parts if type(example) is list else type(example)(*parts)


def another(value: Any, kind: Type) -> Any:
    """A value of the type that differs from this one, if there is any."""
    match kind:
        case BoolType():
            return not value
        case IntType() | TimeType():
            return value - 1 if value > 0 else value + 1
        case EnumType(literals=literals):
            return (value + 1) % len(literals)
        case RealType():
            return 1.0 if value == 0 else 0.0
        case ArrayType(element=element):
            return [another(value[0], element), *value[1:]] if value else value
        case StructType(fields=fields):
            return [another(value[0], fields[0][1]), *value[1:]] if value else value
        case TextType() | UnknownType():
            return value
        case _:
            assert_never(kind)


def _zero(kind: Type) -> Any:
    match kind:
        case BoolType():
            return False
        case RealType():
            return 0.0
        case ArrayType(element=element, size=size):
            return [_zero(element)] * (size or 0)
        case StructType(fields=fields):
            return [_zero(inner) for _, inner in fields]
        case IntType() | TimeType() | EnumType() | TextType() | UnknownType():
            return 0
        case _:
            assert_never(kind)


def replace_environment(environment: Any, inputs: RecordedInputs) -> None:
    """Let an environment of generated Python give recorded inputs, and nothing else."""
    signals = [environment.drivers[port.key] for port in inputs.ports]
    _replace(environment, inputs, [signal.value for signal in signals], lambda at, value: _set(signals[at], value))


def _set(signal: Any, value: Any) -> None:
    signal.value = value


def replace_plant(plant: Any, inputs: RecordedInputs) -> None:
    """The same for the environment of the reference semantics."""
    from cspdiag.semantics.values import zero

    names = [port.name for port in inputs.ports]
    examples = [zero(port.type) for port in inputs.ports]
    _replace(plant, inputs, examples, lambda at, value: plant.signals.__setitem__(names[at], value))


def _replace(environment: Any, inputs: RecordedInputs, examples: list[Any], give: Any) -> None:
    changes = inputs.changes()
    upcoming = next(changes, None)

    def start(self: Any) -> None:
        for at, value in enumerate(inputs.initial):
            give(at, like(examples[at], value))

    def advance(self: Any, now: int) -> None:
        nonlocal upcoming
        while upcoming is not None and upcoming[0] <= now:
            _, at, value = upcoming
            give(at, like(examples[at], value))
            upcoming = next(changes, None)

    kind = type(environment)
    environment.__class__ = type(kind.__name__, (kind,), {"__slots__": (), "start": start, "advance": advance})
