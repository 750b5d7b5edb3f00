"""The parameters of a program in a recording: one signal, a struct with all of them, with its value at the beginning
and after each change; and the changes that a recording has, for runs that repeat it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, assert_never

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
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.runtime.kernel.durations import shown
from cspdiag.runtime.kernel.parameters import Change, with_part
from cspdiag.simulate.record.leaves import leaf, leaves
from cspdiag.simulate.record.stored.described import RecordedPort
from cspdiag.simulate.record.stored.recording import InputsError, StoredRecording, plain

PARAMETERS = "parameters"
"""What the signal is called."""


def parameters_signal(network: CoreNetwork) -> RecordedPort | None:
    """The signal for the parameters of a program; None if it has none."""
    fields = tuple((each.name, each.type) for each in network.parameters if each.follows is None)
    if not fields:
        return None
    is_free = all(port.name != PARAMETERS for port in network.external_ports)
    kind = StructType(f"{network.top}Parameters", fields)
    return RecordedPort(PARAMETERS if is_free else f"program_{PARAMETERS}", kind, "parameter")


class ParameterValues:
    """The values of all parameters during a run, in the order of the signal."""

    def __init__(self, network: CoreNetwork) -> None:
        own = [each for each in network.parameters if each.follows is None]
        self._positions = {each.name: position for position, each in enumerate(own)}
        self.value: tuple[Any, ...] = tuple(each.value for each in own)

    def change(self, parameter: str, path: Sequence[int], value: object) -> tuple[Any, ...]:
        """The values after a change, which was made."""
        self.value = with_part(self.value, (self._positions[parameter], *path), value)
        return self.value


def recorded_changes(network: CoreNetwork, recording: StoredRecording) -> tuple[Change, ...]:
    """The changes with which a run has the parameters of the recorded one, from its beginning. Raises InputsError if
    the program has other parameters.
    """
    port = next((each for each in recording.head.ports if each.direction == "parameter"), None)
    if port is None:
        return ()
    own = parameters_signal(network)
    if own is None or not isinstance(port.type, StructType) or not isinstance(own.type, StructType):
        raise InputsError(f"{recording.path} has changes of parameters, and {network.top} has no parameters")
    if port.type.fields != own.type.fields:
        found, wanted = (_listed(kind) for kind in (port.type, own.type))
        raise InputsError(f"{recording.path} has the parameters {found}, and {network.top} {wanted}")
    return tuple(_changes(own.type, _as_tuples(ParameterValues(network).value), recording, port.name))


def _listed(kind: StructType) -> str:
    return ", ".join(f"{name} ({inner})" for name, inner in kind.fields)


def _changes(kind: StructType, last: Sequence[Any], recording: StoredRecording, name: str) -> Iterator[Change]:
    """A change gives a whole parameter its value: a table does not show in which order its parts were changed."""
    times, values = recording.values(name)
    for time, value in zip(times.tolist(), map(_as_tuples, plain(values)), strict=True):
        for (parameter, _), new, old in zip(kind.fields, value, last, strict=True):
            if repr(new) != repr(old):  # 0.0 and -0.0 are equal, and not the same.
                yield Change(time, parameter, (), new)
        last = value


def _as_tuples(value: Any) -> Any:
    """A value with tuples for structs and arrays."""
    return tuple(map(_as_tuples, value)) if isinstance(value, list | tuple) else value


def shown_values(recording: StoredRecording) -> list[tuple[int, str, str]]:
    """The values of the parameters at the beginning of a recording, and the changes: nanoseconds, what has the value,
    and the value as the language writes it.
    """
    found: list[tuple[int, str, str]] = []
    for port in recording.head.ports:
        if port.direction != "parameter":
            continue
        numbers = list(leaves(port.name, port.type))
        last: Any = None
        times, values = recording.values(port.name)
        for time, value in zip(times.tolist(), plain(values), strict=True):
            for name, kind, path in numbers:
                new = leaf(value, path)
                if last is None or repr(new) != repr(leaf(last, path)):
                    found.append((time, name.partition(".")[2], _written(new, kind)))
            last = value
    return sorted(found, key=lambda change: change[0])


def _written(value: Any, kind: Type) -> str:
    match kind:
        case EnumType(literals=literals):
            return literals[int(value)]
        case BoolType():
            return "true" if value else "false"
        case TimeType():
            return shown(value)
        case IntType() | RealType() | StructType() | ArrayType() | TextType() | UnknownType():
            return repr(value)
        case _:
            assert_never(kind)
