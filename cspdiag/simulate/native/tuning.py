"""Changes of parameters for a native program: the records of ``csp_tuning.h``, in a file or in a pipe."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from tempfile import NamedTemporaryFile
from threading import Lock
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.model.types import StructType
from cspdiag.simulate.native.values import encoded, offset_of, type_at

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.semantics.equations.parameters import Parameters

_HEAD = struct.Struct("=qIIII")


@record
class GivenChanges:
    """How a program is given changes: ``words`` are its options, ``descriptors`` the files that it has open besides,
    and ``changes`` those that were given until now, by their numbers. ``live`` takes more of them while it runs.
    """

    words: tuple[str, ...]
    changes: Sequence[Change]
    descriptors: tuple[int, ...] = ()
    live: LiveChanges | None = None

    def program_started(self) -> None:
        """The program has what it needs: if it ends, nothing more is written to it."""
        for descriptor in self.descriptors:
            os.close(descriptor)


class LiveChanges:
    """Gives a program changes through a pipe, from any thread."""

    def __init__(self, writer: ChangeWriter, descriptor: int) -> None:
        self._writer = writer
        self._descriptor = descriptor
        self._lock = Lock()

    def plan(self, changes: Iterable[Change]) -> None:
        """Give it these; nothing happens if it has ended."""
        with self._lock, suppress(BrokenPipeError):
            for record in self._writer.records(changes):
                if self._descriptor >= 0:
                    os.write(self._descriptor, record)

    def close(self) -> None:
        """The run is over."""
        with self._lock:
            descriptor, self._descriptor = self._descriptor, -1
            os.close(descriptor)


@contextmanager
def given_changes(network: CoreNetwork, changes: Iterable[Change], *, live: bool) -> Iterator[GivenChanges]:
    """What a program is given, as long as it runs; ``live``: more may come."""
    planned = sorted(changes, key=lambda change: change.time)
    writer = ChangeWriter(network)
    if live:
        reading, writing = os.pipe()
        more = LiveChanges(writer, writing)
        try:
            more.plan(planned)
            yield GivenChanges(("--tune", f"/dev/fd/{reading}"), writer.changes, (reading,), more)
        finally:
            more.close()
    elif planned:
        with NamedTemporaryFile(prefix="cspdiag-", suffix=".changes") as file:
            file.writelines(writer.records(planned))
            file.flush()
            yield GivenChanges(("--tune", file.name), writer.changes)
    else:
        yield GivenChanges((), ())


class Refusals:
    """Why a program does not make a change: the reason that the reference semantics give.

    The program reports only that it has not made it. Each change is made here once, when a reason is asked for.
    """

    def __init__(self, network: CoreNetwork) -> None:
        self._network = network
        self._parameters: Parameters | None = None
        self._made: list[Change] = []
        """The changes that the program has made and the reference semantics have not."""

    def made(self, change: Change) -> None:
        """The program has made this change."""
        self._made.append(change)

    def reason(self, refused: Change) -> str:
        """Why it does not make this one."""
        from cspdiag.semantics.equations import parameters as semantics

        if self._parameters is None:
            self._parameters = semantics.Parameters(self._network.parameters)
        changes = [
            semantics.Change(0, change.parameter, change.path, change.value) for change in (*self._made, refused)
        ]
        self._made.clear()
        self._parameters.coming.extend(changes)
        return self._parameters.reach(0)[-1][1]


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
        value = encoded(type_at(self._all, path), change.value)
        number = len(self.changes)
        self.changes.append(change)
        return _HEAD.pack(change.time, number, offset_of(self._all, path), len(value), 0) + value
