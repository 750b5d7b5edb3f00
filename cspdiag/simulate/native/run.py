"""Runs a network as a native program: generated as C, built in a cache, with the same records as a run in Python."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from io import BufferedIOBase
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryFile
from typing import IO, TYPE_CHECKING, Literal

from cspdiag.base.record import record
from cspdiag.base.standard_streams import standard_error
from cspdiag.codegen.c.package.linkage import NAMES, NO_NAMES
from cspdiag.codegen.c.package.package import support_files
from cspdiag.codegen.c.package.parts import PARTS
from cspdiag.codegen.c.package.refusals import refuse_devices
from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.pipeline import Reader, generate
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.simulate.deadlock.report import deadlock_report
from cspdiag.simulate.fmu.loadable import require_loadable
from cspdiag.simulate.native.boards import Board
from cspdiag.simulate.native.build import Build, CompilerError
from cspdiag.simulate.native.monitor import ProgramMonitor
from cspdiag.simulate.native.recorded_inputs import VARIABLE, with_recorded_inputs, write_inputs
from cspdiag.simulate.native.recorded_rows import RecordedRows
from cspdiag.simulate.native.rows import PassedRows
from cspdiag.simulate.native.stream import CHUNK, EndRecord, StreamReader
from cspdiag.simulate.native.supervisor import Supervisor, how_it_ended
from cspdiag.simulate.native.tuning import GivenChanges, LiveChanges, given_changes
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import chosen_environment

if TYPE_CHECKING:
    from cspdiag.runtime import Outcome
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.runtime.outcome import Ending
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording

Observed = Literal["all", "ports", "signals", "none"]
"""What is reported: all communications; those of external ports; of those only what a recording has; or nothing."""


@record
class NativeRun:
    """A running native program; its state is the later of what its records and the observing thread report."""

    reader: StreamReader
    monitor: ProgramMonitor
    changes: LiveChanges | None = None

    @property
    def parameters(self) -> LiveChanges:
        """Its parameters: changes of them may be planned, if it was started for that."""
        assert self.changes is not None
        return self.changes

    @property
    def now(self) -> int:
        """The latest known instant in nanoseconds."""
        return max(self.reader.now, self.monitor.now)

    @property
    def over(self) -> bool:
        """Whether the program has reported how it ended."""
        return self.reader.end is not None

    def running_processes(self) -> list[str]:
        """The processes that were found running since the present instant began, each with its place."""
        return self.monitor.running_processes


POSIX_SOURCES = (
    "csp_signals.c", "csp_simulation_posix.c", "csp_steering_posix.c", "csp_stream_posix.c", "csp_tuning_posix.c",
    "csp_watch.c",
)  # fmt: skip
"""The files of the kernel for simulations on this machine only."""

_ENDINGS: tuple[Ending, ...] = ("terminated", "failed", "deadlock", "time limit", "stopped")


def simulate(
    network: CoreNetwork,
    read: Reader,
    *,
    level: int = 0,
    environment: str | None = None,
    until: int | None = None,
    real_time: bool = False,
    recorder: Recorder | None = None,
    on_start: Callable[[NativeRun], None] | None = None,
    observed: Observed = "all",
    fused: bool = False,
    measured: bool = False,
    board: Board | None = None,
    options: tuple[str, ...] = ("-O2",),
    recording: Recording | None = None,
    inputs: RecordedInputs | None = None,
    changes: Iterable[Change] = (),
    live: bool = False,
) -> Run:
    """Generate, build and run a program; see ``build_program`` and ``NativeProgram.run``."""
    program = build_program(
        network, read, level=level, environment=environment, real_time=real_time, fused=fused, measured=measured,
        board=board, options=options, inputs=inputs,
    )  # fmt: skip
    return program.run(
        until=until, recorder=recorder, on_start=on_start, observed=observed, recording=recording, inputs=inputs,
        changes=changes, live=live,
    )  # fmt: skip


def build_program(
    network: CoreNetwork,
    read: Reader,
    *,
    level: int = 0,
    environment: str | None = None,
    real_time: bool = False,
    fused: bool = False,
    measured: bool = False,
    board: Board | None = None,
    options: tuple[str, ...] = ("-O2",),
    replaced: Mapping[str, str] | None = None,
    inputs: RecordedInputs | None = None,
) -> NativeProgram:
    """Generate and build a program; ``real_time`` makes it run against the clock of a POSIX system, ``board`` on that
    board instead of this machine, in virtual time.

    With ``measured`` the recorder gets the longest step of each process. ``fused`` programs run processes as one where
    that is possible, and do not report when each starts and ends. ``replaced`` are files of the package, by path, that
    get other texts. With ``inputs``, which each run has to be given, the environment gives those. Raises
    NoEnvironmentError, TargetError for what C cannot express, and CompilerError.
    """
    chosen = chosen_environment(network, environment)
    if chosen is not None:
        refuse_devices(chosen)
    with stopping.raising():
        if board is not None:
            board.require_tools()
        shared = {NAMES: NO_NAMES, PARTS: support_files()[PARTS.rpartition("/")[2]]}
        files = {**generate(network, read, "c", level, observed=not fused), **shared, **(replaced or {})}
        if inputs is not None and chosen is not None:
            files = with_recorded_inputs(files, chosen.name, inputs)
        if chosen is not None:
            require_loadable(chosen)
        path = Build(
            files,
            _chosen_sources(files, real_time, board),
            (
                *(() if board else options),
                "-DCSP_TRACE=1",
                "-DCSP_USES_TEXTS=1",
                *(("-DCSP_MEASURE=1",) if measured else ()),
            ),
            toolchain=None if board is None else board.toolchain,
        ).executable()
    return NativeProgram(network, chosen, path, real_time, flattened=level > 0, board=board)


@record
class NativeProgram:
    """A network that was built for this machine or a ``board``, at ``path``, with one of its environments.

    ``flattened``: whether processes are inlined in the thread that runs them, as with ``-O1``.
    """

    network: CoreNetwork
    environment: Environment | None
    path: Path
    real_time: bool
    flattened: bool
    board: Board | None = None

    def run(
        self,
        *,
        until: int | None = None,
        recorder: Recorder | None = None,
        on_start: Callable[[NativeRun], None] | None = None,
        observed: Observed = "all",
        recording: Recording | None = None,
        inputs: RecordedInputs | None = None,
        changes: Iterable[Change] = (),
        live: bool = False,
    ) -> Run:
        """Run it; ``until`` is a time limit in nanoseconds. ``recording`` is given the values of the external ports
        while the run continues; the caller finishes it. With ``observed="signals"`` they are not kept besides.
        ``changes`` are those of parameters of the program; ``live``: more are planned while it runs.

        ``on_start`` is passed an object whose ``now`` is the present instant, and whose ``parameters`` take changes
        from any thread if the run is ``live``. Ctrl-C and what the program raises end
        the run with an outcome, not with an exception. Raises CompilerError for a program that fails otherwise.
        """
        recorder = recorder if recorder is not None else Recorder()
        words = ["--observe", observed]
        if self.environment is not None:
            words += ["--environment", self.environment.name]
        if until is not None:
            words += ["--for", str(until)]
        kept = None if observed == "none" else PassedRows(self.network, keeps_order=observed != "signals")
        passed: PassedRows | RecordedRows | None = kept
        if kept is not None and recording is not None:
            passed = RecordedRows(self.network, recording, None if observed == "signals" else kept)
        try:
            with variables_of(inputs) as variables, given_changes(self.network, changes, live=live) as given:
                outcome = _run(self, [*words, *given.words], variables, recorder, passed, on_start, given)
        finally:
            if isinstance(passed, RecordedRows):
                passed.hand_over()
        return Run(self.network, self.environment, outcome, recorder, passed)


def _chosen_sources(files: Iterable[str], real_time: bool, board: Board | None = None) -> list[str]:
    """The sources of the simulation, with those for one machine only."""
    port = "csp_port_posix.c" if real_time else "csp_port_simulation.c"
    chosen = {port, *(POSIX_SOURCES if board is None else board.sources)}
    sources = [path for path in files if path.endswith(".c")]
    names = {path: path.rpartition("/")[2] for path in sources}
    return [
        path
        for path, name in names.items()
        if name in chosen or not (name.startswith("csp_port_") or name in POSIX_SOURCES)
    ]


@contextmanager
def started(
    program: NativeProgram,
    words: list[str],
    variables: Mapping[str, str],
    monitor: ProgramMonitor,
    given: GivenChanges,
    errors: IO[bytes] | None,
    descriptors: tuple[int, ...] = (),
) -> Iterator[tuple[subprocess.Popen[bytes], BufferedIOBase]]:
    """The program as a process, which inherits ``descriptors``, and what it writes; texts for people go to ``errors``,
    a file, because a pipe that nobody reads would become full; None: the standard error of this process.

    It has a session of its own: Ctrl-C reaches this process, which forwards it once, so outputs are released and
    everything is reported.
    """
    reading, writing = os.pipe()
    lifeline, held = os.pipe()
    if program.board is None:
        command = [str(program.path), *words, "--lifeline", str(lifeline), "--checks", str(monitor.descriptor)]
    else:
        command = program.board.command(str(program.path), [*words, "--stream", f"/dev/fd/{writing}"])
    on_board = program.board is not None
    with os.fdopen(reading, "rb") as stream, os.fdopen(held, "wb"):
        try:
            running = subprocess.Popen(
                command,
                env={**os.environ, **variables},
                stdin=subprocess.DEVNULL if on_board else None,
                stdout=subprocess.DEVNULL if on_board else writing,
                stderr=errors,
                start_new_session=True,
                pass_fds=[
                    *([writing] if on_board else [monitor.descriptor, lifeline]),
                    *given.descriptors,
                    *descriptors,
                ],
            )
        finally:
            os.close(writing)
            os.close(lifeline)
            given.program_started()
        monitor.started()
        _enlarge(stream)
        with running:
            yield running, stream


@contextmanager
def variables_of(inputs: RecordedInputs | None) -> Iterator[Mapping[str, str]]:
    """The environment variables of a program with these inputs, which are in a file as long as it runs."""
    if inputs is None:
        yield {}
        return
    with NamedTemporaryFile(prefix="cspdiag-", suffix=".inputs") as file:
        write_inputs(inputs, file.file)
        file.flush()
        yield {VARIABLE: file.name}


def _run(
    program: NativeProgram,
    words: list[str],
    variables: Mapping[str, str],
    recorder: Recorder,
    passed: PassedRows | RecordedRows | None,
    on_start: Callable[[NativeRun], None] | None,
    given: GivenChanges,
) -> Outcome:
    with (
        stopping,
        ProgramMonitor() as monitor,
        TemporaryFile() as errors,
        # Against the clock it reports how late it met the instants, for people who look on.
        started(program, words, variables, monitor, given, None if program.real_time else errors) as (running, stream),
        Supervisor(running) as supervisor,
    ):
        reader = StreamReader(
            stream, program.network, recorder, passed, changes=given.changes, flattened=program.flattened
        )
        run = NativeRun(reader, monitor, given.live)
        if on_start is not None:
            on_start(run)
        try:
            with suppress(EOFError):  # It was killed in the middle of a record, and has not reported its end.
                reader.read()
            supervisor.end_reported()
            running.wait()
        except BaseException:
            running.kill()
            raise
        errors.seek(0)
        written = errors.read()
    outcome = _outcome(run, supervisor, running.returncode, program.environment, program.network)
    if outcome is None:
        raise CompilerError(f"the native program has failed: {how_it_ended(running.returncode, written)}")
    if program.board is None:
        # Of bodies in C: the program itself writes nothing.
        standard_error().write(written.decode("utf-8", "replace"))
    else:
        outcome.wall_time = monitor.wall_time
    outcome.real_time = program.real_time
    return outcome


def _enlarge(pipe: BufferedIOBase) -> None:
    """Let a pipe hold what is read at a time, where the system allows that: the program waits less often."""
    import fcntl

    with suppress(AttributeError, OSError):
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, CHUNK)


def _outcome(
    run: NativeRun, supervisor: Supervisor, code: int, environment: Environment | None, network: CoreNetwork
) -> Outcome | None:
    """How the run ended; None if the program, whose exit ``code`` is given, has not reported that."""
    from cspdiag.runtime import Outcome

    reader, end = run.reader, run.reader.end
    if end is None:
        if not supervisor.signal:
            return None
        outcome = Outcome("stopped", run.now, wall_time=run.monitor.wall_time, signal=supervisor.signal)
        # Otherwise the program was stuck in a step and ended by itself, with its outputs released and no time to
        # report.
        if supervisor.killed:
            outcome.release_errors.append(supervisor.kill_error)
        return outcome
    outcome = reported_outcome(reader, end, environment, network)
    if outcome.ended == "stopped":
        outcome.signal = supervisor.stopped_by(code)
    if supervisor.killed:
        outcome.release_errors.append(supervisor.kill_error)
    return outcome


def reported_outcome(
    reader: StreamReader, end: EndRecord, environment: Environment | None, network: CoreNetwork
) -> Outcome:
    """How the run ended, as the program has reported it."""
    from cspdiag.runtime import Outcome

    ended = _ENDINGS[end.ending]
    outcome = Outcome(ended, end.time, missed=reader.missed, wall_time=end.duration)
    if ended == "failed":
        outcome.error = failure_of(
            end.exception, end.message, end.place, "" if environment is None else environment.name
        )
    if ended == "deadlock":
        outcome.deadlock = deadlock_report(end.time, reader.waiting, network, reader.recorder)
    return outcome


def failure_of(exception: str, message: str, place: str, environment: str) -> BaseException:
    """The exception with which the same program ends in Python, from what a native program reports of it."""
    from cspdiag.runtime.kernel.exceptions import EnvironmentFailure, Fault, Place, ProcessError, Timeout

    process, _, statement = place.partition(" (")
    at = Place(process, statement.removesuffix(")") or None) if process else None
    if not exception:
        return EnvironmentFailure(environment, Fault(message), at)
    if exception == "Fault":
        return Fault(message, at)
    kind: type[ProcessError] = Timeout if exception == "Timeout" else type(exception, (ProcessError,), {})
    error = kind(*([message] if message else []))
    error.place = at
    return error
