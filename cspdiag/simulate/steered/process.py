"""A steered native program as a process: it is given orders, and what it reports is read until it has followed them."""

from __future__ import annotations

import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from select import select
from tempfile import TemporaryFile
from typing import TYPE_CHECKING
from weakref import finalize

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.kernel.exceptions import OutsideError
from cspdiag.runtime.kernel.signals import exit_code_of
from cspdiag.runtime.outcome import Outcome
from cspdiag.simulate.native.monitor import ProgramMonitor
from cspdiag.simulate.native.run import NativeProgram, reported_outcome, started, variables_of
from cspdiag.simulate.native.stream import HeldRecord, StreamReader
from cspdiag.simulate.native.supervisor import how_it_ended
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
_PATIENCE_TO_PAUSE = 0.1
"""Seconds in which the program pauses, unless one of its steps takes longer."""
_PATIENCE_TO_END = 1.9
"""Seconds in which the program is to end. One of which a step does not end releases its outputs after one second
(``csp_signals.h``), so what has not ended then hangs in a device.
"""
_LATENESS = re.compile(rb"^\d+ instants, late by .*$", re.MULTILINE)
"""What a program in real time writes at its end (``csp_port_posix.c``)."""


class ProgramGoneError(OutsideError, CspdiagError):
    """A native program has ended without a report, or had to be killed."""


class SteeredProcess:
    """A native program up to ``until``: in virtual time it waits for orders at time 0, in real time it has begun.

    It ends with its outputs released when this process ends, however that happens. ``outcome`` is how it has ended.
    """

    def __init__(
        self, program: NativeProgram, until: int, recorder: SteeredRecorder, inputs: RecordedInputs | None
    ) -> None:
        self.orders = Orders()
        finalize(self, self.orders.close)  # Should it be forgotten before it has ended.
        self.outcome: Outcome | None = None
        self.lateness = ""
        """How late a run in real time was that has ended, for people."""
        self._program = program
        self._recorder = recorder
        self._is_asked_to_pause = False
        steered = str(self.orders.descriptor)
        words = ["--observe", "all", "--for", str(until), "--steer", steered]
        if program.environment is not None:
            words += ["--environment", program.environment.name]
        with ExitStack() as entered:
            entered.callback(self.orders.close)
            self._monitor = entered.enter_context(ProgramMonitor())
            given = entered.enter_context(given_changes(program.network, (), live=True))
            variables = entered.enter_context(variables_of(inputs))
            self._errors = entered.enter_context(TemporaryFile())
            self._process, self._stream = entered.enter_context(
                started(
                    program, [*words, *given.words], variables, self._monitor, given, self._errors,
                    (self.orders.descriptor,),
                )
            )  # fmt: skip
            self.orders.program_started()
            entered.callback(self._end_process)
            entered.callback(self._ask_to_end)
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

    @property
    def is_busy(self) -> bool:
        """Whether it has not carried out the last order: one of its steps takes long."""
        return self.outcome is None and self._reader.held is None

    def plan(self, changes: Iterable[Change]) -> None:
        """Change parameters, at the first instants at or after the times of the changes."""
        self._changes.plan(changes)

    def advance(self, until: int) -> None:
        """Give the order to continue up to an instant, unless it ``is_busy``."""
        self._await_answer()
        self.orders.advance(until)

    def step(self, until: int, communications: int) -> None:
        """The same, until that many values were communicated."""
        self._await_answer()
        self.orders.step(until, communications)

    def _await_answer(self) -> None:
        self._reader.held = None
        self._is_asked_to_pause = False

    def answer(self, wants_pause: Callable[[], bool] = lambda: False) -> HeldRecord:
        """Read until the order that was given is carried out, or it is paused before that, or it has ended. If it does
        not pause, because a step takes long, it is busy after that, and may be asked again.
        """
        reader, kept = self._reader, self._recorder.rows
        since: float | None = None
        while reader.held is None:
            ready, _, _ = select([self._stream], [], [], _INTERVAL)
            if since is None and (wants_pause() or kept.size > _AT_ONCE):
                since = time.monotonic()
                if not self._is_asked_to_pause:
                    self.orders.pause()
                    self._is_asked_to_pause = True
            if ready and not self._read_some():
                self._note_end()
                return HeldRecord(True, None)
            if since is not None and reader.held is None and time.monotonic() > since + _PATIENCE_TO_PAUSE:
                return HeldRecord(False, None)
        return reader.held

    def keep_pace(self, seconds: float) -> None:
        """Read what comes in this time from a program in real time, or until it has ended."""
        over = time.monotonic() + seconds
        while (left := over - time.monotonic()) > 0 and self._recorder.rows.size <= _AT_ONCE:
            ready, _, _ = select([self._stream], [], [], left)
            if ready and not self._read_some():
                self._note_end()
                return

    def waiting(self) -> tuple[WaitingRecord, ...]:
        """The processes that wait. Of a program that is busy it is not known."""
        if self.is_busy:
            return ()
        self._await_answer()
        self.orders.report()
        return self.answer(lambda: True).waiting

    def end(self) -> None:
        """Let it end where it is, and release its outputs; it is killed if it does not do that soon."""
        if self.outcome is not None:
            return
        self._ask_to_end()
        if not self._reads_to_the_end():
            self._process.kill()
        self._note_end(is_wanted=True)

    def _ask_to_end(self) -> None:
        self.orders.close()
        self._process.terminate()

    def _reads_to_the_end(self) -> bool:
        over = time.monotonic() + _PATIENCE_TO_END
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
        self._end_process()
        if end is not None:
            self.outcome = reported_outcome(self._reader, end, program.environment, program.network)
        else:
            error = ProgramGoneError(self._why_forced() if is_wanted else self._why())
            self.outcome = Outcome("stopped" if is_wanted else "failed", self.now, None if is_wanted else error)
            if is_wanted:
                self.outcome.release_errors.append(error)
        self.outcome.real_time = program.real_time
        self.lateness = b"\n".join(_LATENESS.findall(self._written())).decode()

    def _why(self) -> str:
        return f"the native program has failed: {how_it_ended(self._process.returncode, self._written())}"

    def _why_forced(self) -> str:
        """Why a program was ended by force, and what that means for its outputs."""
        working = " and ".join(self._monitor.running_processes) or "the native program"
        code = self._process.returncode
        if code == exit_code_of(signal.SIGTERM):
            text = f"{working} did not end and was interrupted; the outputs have their safe values"
        elif code == -signal.SIGKILL:
            text = f"{working} did not end within {_PATIENCE_TO_END:g} s, nor did what releases the outputs"
            text = f"{text}: the native program was killed, and outputs may be as they were"
        else:
            text = self._why()
        return text

    def _written(self) -> bytes:
        """What it has written for people."""
        self._errors.seek(0)
        return self._errors.read()

    def _end_process(self) -> None:
        """Nothing of it is left."""
        try:
            self._process.wait(_PATIENCE_TO_END)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def close(self) -> None:
        """The run is over."""
        self._entered.close()
