"""A steered native program as a process: it is given orders, and what it reports is read until it has followed them."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from select import select
from tempfile import TemporaryFile
from typing import TYPE_CHECKING
from weakref import finalize

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.outcome import Outcome
from cspdiag.simulate.native.monitor import ProgramMonitor
from cspdiag.simulate.native.run import NativeProgram, how_it_ended, reported_outcome, started, variables_of
from cspdiag.simulate.native.stream import HeldRecord, StreamReader
from cspdiag.simulate.native.tuning import given_changes
from cspdiag.simulate.steered.orders import Orders
from cspdiag.simulate.steered.recorder import SteeredRecorder

if TYPE_CHECKING:
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.simulate.deadlock.waiting import WaitingRecord
    from cspdiag.simulate.record.stored.inputs import RecordedInputs

_INTERVAL = 0.005
"""Seconds between two questions whether to pause."""
_AT_ONCE = 1 << 21
"""The most bytes of rows that are kept before a run is paused, so that they can be looked at."""
_LONGEST = 2000
"""Bytes of what a program that has crashed has written for people."""
_PATIENCE = 1.5
"""Seconds in which the program is to end, first by itself, then by a signal after which it releases its outputs."""


class ProgramGoneError(CspdiagError):
    """A native program has ended without a report, or had to be killed."""


class SteeredProcess:
    """A native program in virtual time, up to ``until``, which waits for orders at time 0.

    It ends with its outputs released when this process ends, however that happens. ``outcome`` is how it has ended.
    """

    def __init__(
        self, program: NativeProgram, until: int, recorder: SteeredRecorder, inputs: RecordedInputs | None
    ) -> None:
        self.orders = Orders()
        finalize(self, self.orders.close)  # Should it be forgotten before it has ended.
        self.outcome: Outcome | None = None
        self._program = program
        self._recorder = recorder
        steered = str(self.orders.descriptor)
        words = ["--observe", "all", "--for", str(until), "--steer", steered]
        if program.environment is not None:
            words += ["--environment", program.environment.name]
        with ExitStack() as entered:
            entered.callback(self.orders.close)
            monitor = entered.enter_context(ProgramMonitor())
            given = entered.enter_context(given_changes(program.network, (), live=True))
            variables = entered.enter_context(variables_of(inputs))
            self._errors = entered.enter_context(TemporaryFile())
            self._process, self._stream = entered.enter_context(
                started(
                    program, [*words, *given.words], variables, monitor, given, self._errors, (self.orders.descriptor,)
                )
            )
            self.orders.program_started()
            entered.callback(self._end_process)
            assert given.live is not None
            self._changes = given.live
            self._reader = StreamReader(
                self._stream, program.network, recorder, recorder.rows, changes=given.changes,
                flattened=program.flattened,
            )  # fmt: skip
            self.answer()
            self._entered = entered.pop_all()
        if self.outcome is not None:
            self._entered.close()

    @property
    def now(self) -> int:
        """The instant of what was read last."""
        return self._reader.now

    @property
    def missed(self) -> dict[str, int]:
        """The samples that were missed until now, by the hierarchical names of the inputs."""
        return self._reader.missed

    def plan(self, changes: Iterable[Change]) -> None:
        """Change parameters, at the first instants at or after the times of the changes."""
        self._changes.plan(changes)

    def answer(self, wants_pause: Callable[[], bool] = lambda: False) -> HeldRecord:
        """Read until the order that was given is carried out, or it is paused before that, or it has ended."""
        reader, kept = self._reader, self._recorder.rows
        reader.held = None
        is_asked = False
        while reader.held is None:
            ready, _, _ = select([self._stream], [], [], _INTERVAL)
            if not is_asked and (wants_pause() or kept.size > _AT_ONCE):
                self.orders.pause()
                is_asked = True
            if ready and not self._read_some():
                self._note_end()
                return HeldRecord(True, None)
        return reader.held

    def waiting(self) -> list[WaitingRecord]:
        """The processes that wait."""
        self.orders.report()
        self.answer()
        found, self._reader.waiting = self._reader.waiting, []
        return found

    def end(self) -> None:
        """Let it end where it is, and release its outputs."""
        if self.outcome is not None:
            return
        self.orders.close()
        if not self._reads_to_the_end():
            self._process.terminate()
            if not self._reads_to_the_end():
                self._process.kill()
        self._note_end(is_wanted=True)

    def _reads_to_the_end(self) -> bool:
        over = time.monotonic() + _PATIENCE
        while (left := over - time.monotonic()) > 0:
            ready, _, _ = select([self._stream], [], [], left)
            if ready and not self._read_some():
                return True
        return False

    def _read_some(self) -> bool:
        self._reader.passed = self._recorder.rows
        try:
            return self._reader.read_some()
        except EOFError:
            return False

    def _note_end(self, *, is_wanted: bool = False) -> None:
        """It has ended, or was killed."""
        end, program = self._reader.end, self._program
        if end is not None:
            self.outcome = reported_outcome(self._reader, end, program.environment, program.network)
        else:
            error = self._account()
            self.outcome = Outcome("stopped" if is_wanted else "failed", self.now, None if is_wanted else error)
            if is_wanted:
                self.outcome.release_errors.append(error)

    def _account(self) -> ProgramGoneError:
        self._end_process()
        self._errors.seek(0)
        text = self._errors.read(_LONGEST).decode("utf-8", "replace").strip()
        return ProgramGoneError(f"the native program has failed: {text or how_it_ended(self._process.returncode)}")

    def _end_process(self) -> None:
        """Nothing of it is left."""
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def close(self) -> None:
        """The run is over."""
        self._entered.close()
