"""Changes of parameters for a native program: the records of ``csp_tuning.h``."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import TYPE_CHECKING

from cspdiag.model.types import ArrayType, StructType, Type
from cspdiag.simulate.native.values import encoded, offset_of

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.kernel.parameters import Change

_HEAD = struct.Struct("=qIIII")


class ChangeWriter:
    """Makes records of changes, and remembers the changes by their numbers."""

    def __init__(self, network: CoreNetwork) -> None:
        own = [(item.name, item.type) for item in network.parameters if item.follows is None]
        self._all = StructType("parameters", tuple(own))
        self._positions = {name: position for position, (name, _) in enumerate(own)}
        self.changes: list[Change] = []

    def records(self, changes: Iterable[Change]) -> list[bytes]:
        """The records, each with its value."""
        return [self._record(change) for change in changes]

    def _record(self, change: Change) -> bytes:
        path = (self._positions[change.parameter], *change.path)
        value = encoded(_type_at(self._all, path), change.value)
        number = len(self.changes)
        self.changes.append(change)
        return _HEAD.pack(change.time, number, offset_of(self._all, path), len(value), 0) + value


def _type_at(kind: Type, path: tuple[int, ...]) -> Type:
    for position in path:
        match kind:
            case StructType():
                kind = kind.fields[position][1]
            case ArrayType():
                kind = kind.element
            case _:
                raise ValueError(f"{kind} has no parts")
    return kind
