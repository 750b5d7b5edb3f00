"""Runs of a sweep in a native process, which makes one after the other; the records are those of ``csp_sweep.h``."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from math import isnan
from pathlib import Path
from typing import IO, TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.codegen.c.package.linkage import NAMES
from cspdiag.codegen.c.package.package import support_files
from cspdiag.codegen.c.package.parts import PARTS
from cspdiag.codegen.c.package.refusals import refuse_devices
from cspdiag.codegen.c.package.sweep import generate
from cspdiag.model.types import RealType, StructType, TimeType
from cspdiag.network.ir.external import external_bodies
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.simulate.fmu.loadable import require_loadable
from cspdiag.simulate.native.build import Build, CompilerError
from cspdiag.simulate.native.run import POSIX_SOURCES, failure_of
from cspdiag.simulate.native.values import encoded, letter_of, offset_of, type_at
from cspdiag.sweep.measures import KINDS, Measures, Signal
from cspdiag.sweep.result import Ended, Result, without_measures

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork, Environment
    from cspdiag.pipeline import Reader
    from cspdiag.sweep.plan import Plan, Variant

_HEAD = struct.Struct("=qII")
_SIGNAL = struct.Struct("=IIII")
_MEASURE = struct.Struct("=IIIIdd")
_RESULT = struct.Struct("=qiI")
_NOTHING = 0xFFFFFFFF
_ENDINGS: tuple[Ended, ...] = ("terminated", "failed", "deadlock", "time limit", "crashed", "refused")

_NOT_LINKED = {*POSIX_SOURCES, "csp_signals.c", "csp_simulation.c", "csp_stream.c"}
"""Parts of a usual simulation."""


@record
class NativeSource:
    """The files of a program for sweeps; ``runs_once``: each process makes one run only."""

    files: Mapping[str, str]
    sources: tuple[str, ...]
    runs_once: bool

    def executable(self) -> Path:
        """Build it, unless it is in the cache. Raises CompilerError."""
        options = ("-O2", "-DCSP_TRACE=1", "-DCSP_USES_TEXTS=1")
        try:
            # The kernel and the program as one: a quarter less time.
            return Build(self.files, self.sources, (*options, "-flto")).executable()
        except CompilerError:
            return Build(self.files, self.sources, options).executable()


def native_source(network: CoreNetwork, environment: Environment | None, reader: Reader) -> NativeSource:
    """The program for all runs of a variant. Raises TargetError for what C cannot express."""
    from cspdiag.codegen import external_modules

    if environment is not None:
        refuse_devices(environment)
    modules = external_modules(network, reader, "c")
    files = generate(network, modules, environment)
    files = {**files, PARTS: support_files()[PARTS.rpartition("/")[2]]}
    assert NAMES in files
    if environment is not None:
        require_loadable(environment)
    sources = tuple(path for path in files if path.endswith(".c") and _is_linked(path.rpartition("/")[2]))
    # What is written by hand, or by others, may keep something from one run to the next.
    others = any(external_bodies(network.classes, network.environments))
    return NativeSource(files, sources, others)


def _is_linked(name: str) -> bool:
    return name == "csp_port_simulation.c" or not (name.startswith("csp_port_") or name in _NOT_LINKED)


@record
class NativeMaker:
    """A native program for sweeps, and what is exchanged with it."""

    source: NativeSource
    head: bytes
    measures: int
    environment: str

    @property
    def runs_once(self) -> bool:
        """Whether each run needs a process of its own."""
        return self.source.runs_once

    def command(self) -> tuple[str, ...]:
        """The program, which is built unless it is in the cache. Raises CompilerError."""
        return (str(self.source.executable()),)

    def read(self, stream: IO[bytes]) -> Result | None:
        """The next result; None if the process has ended before that."""
        head = stream.read(_RESULT.size)
        values = stream.read(8 * self.measures)
        if len(head) < _RESULT.size or len(values) < 8 * self.measures:
            return None
        time, ending, length = _RESULT.unpack(head)
        text = stream.read(length)
        if len(text) < length:
            return None
        ended = _ENDINGS[ending]
        if ended == "refused":
            return without_measures("refused", "", self.measures)
        error = ""
        if ended == "failed":
            exception, message, place, _ = text.decode("utf-8", "replace").split("\0")
            error = described(failure_of(exception, message, place, self.environment))
        numbers = struct.unpack(f"={self.measures}d", values)
        return Result(ended, time / 1e9, error, tuple(None if isnan(value) else value for value in numbers))


def native_maker(plan: Plan, variant: Variant, reader: Reader) -> NativeMaker:
    """What makes the runs of a variant. Raises TargetError for what C cannot express."""
    assert variant.network is not None
    environment = variant.environment
    source = native_source(variant.network, environment, reader)
    head = _head(plan.measures, plan.request.until)
    return NativeMaker(source, head, len(plan.measures.measures), "" if environment is None else environment.name)


class ParameterWriter:
    """Makes the structure of the parameters for each run of a variant."""

    def __init__(self, plan: Plan, network: CoreNetwork) -> None:
        self._plan = plan
        own = [item for item in network.parameters if item.follows is None]
        self._type = StructType("parameters", tuple((item.name, item.type) for item in own))
        self._first = encoded(self._type, [item.value for item in own]) if own else b"\0"
        self._positions = {item.name: at for at, item in enumerate(own)}

    def task(self, run: int) -> bytes:
        """The structure for a run; a byte if there are no parameters."""
        data = bytearray(self._first)
        for name, part, value in self._plan.parameter_values(run):
            if name not in self._positions:
                continue  # Nothing in this program depends on it.
            path = (self._positions[name], *part)
            type_ = type_at(self._type, path)
            # A `time` that is used in equations only is a number of seconds there.
            piece = encoded(type_, value.cell if isinstance(type_, RealType) else value.value)
            place = offset_of(self._type, path)
            data[place : place + len(piece)] = piece
        return bytes(data)


def _head(measures: Measures, until: int | None) -> bytes:
    parts = [_HEAD.pack(-1 if until is None else until, len(measures.signals), len(measures.measures))]
    parts += [_signal(signal) for signal in measures.signals]
    for measure in measures.measures:
        other = _NOTHING if measure.subtracted is None else measure.subtracted
        kind = KINDS.index(measure.kind)
        parts.append(_MEASURE.pack(kind, measure.signal, other, measure.absolute, measure.target, measure.tolerance))
    return b"".join(parts)


def _signal(signal: Signal) -> bytes:
    letter = "T" if isinstance(signal.type, TimeType) else letter_of(signal.type)
    return _SIGNAL.pack(signal.number, offset_of(signal.whole, signal.path), ord(letter), signal.source == "state")
