"""The results of a run: its files, its summary, and the exit code."""

from __future__ import annotations

from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any

from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import WRONG_USAGE, described
from cspdiag.cli.support.runs.missed import explained_timeout
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.model.program import Program
    from cspdiag.pipeline import Checked
    from cspdiag.simulate.record.streamed.recording import Recording
    from cspdiag.simulate.result import Run

_Writer = Callable[[Any], object]
_PATIENCE = 2.0
"""Seconds after which a recording that is still being written is announced."""


class _RecordingFailedError(Exception):
    """A recording is not whole, or was not written, as a message has said."""


def conclude(arguments: Namespace, result: Run, checked: Checked, recording: Recording | None = None) -> int:
    """Write what was requested, report how the run ended, and return the exit code.

    The files of a run that was stopped are written like those of any other. A signal during that, after a run that
    ended by itself, ends the command.
    """
    from cspdiag.runtime.kernel.signals import name_of_signal
    from cspdiag.runtime.kernel.stopping import Stopped, stopping

    if result.outcome.deadlock is not None:
        say(result.outcome.deadlock.text)
    _say_refused_changes(result)
    requested = deque(_requested_files(arguments, result, checked.program, recording))
    paths = [path for path, _ in requested]
    if stopping.signal:
        missing = _write(requested)
    else:
        try:
            with stopping.raising():
                missing = _write(requested)
        except Stopped as stopped:
            left = ", ".join(on_one_line(path) for path, _ in requested)
            say(f"cspdiag: stopped by {name_of_signal(stopped.signal)} before {left} had been written")
            if recording is not None:
                recording.abandon()
            return stopped.exit_code
    _print_summary(arguments, result, checked, [str(path) for path in paths if path not in missing])
    return result.outcome.exit_code or (WRONG_USAGE if missing else 0)


def _say_refused_changes(result: Run) -> None:
    from cspdiag.runtime.kernel.durations import shown

    for time, parameter, why in result.refused_changes:
        reason = why or "the value is not finite, or what follows from it cannot be computed"
        say(f"cspdiag: {parameter} was not changed at {shown(time)}: {reason}")


def _requested_files(
    arguments: Namespace, result: Run, program: Program | None, recording: Recording | None
) -> Iterator[tuple[Path | str, _Writer]]:
    if recording is not None and arguments.record is None:
        _finish(recording, result)
    elif recording is not None:
        yield arguments.record, lambda path: _finish_file(path, recording, result)
    if arguments.trace is not None:
        yield arguments.trace, result.to_trace
    if arguments.plot is not None:
        yield arguments.plot, result.plot
    if arguments.json is not None:
        yield arguments.json, lambda path: _write_json(path, result)
    if arguments.draw_deadlock is not None and result.outcome.deadlock is not None:
        yield arguments.draw_deadlock, lambda path: _draw_deadlock(path, result, program)


def _write_json(path: Path | str, result: Run) -> None:
    from cspdiag.cli.support.files.output import replace_text
    from cspdiag.simulate.result_json import result_text

    replace_text(str(path), result_text(result))


def _finish(recording: Recording, result: Run) -> None:
    recording.finish(result.outcome.ended, result.outcome.time, result.releases)
    if recording.problem is not None:
        raise _RecordingFailedError


def _finish_file(path: Path | str, recording: Recording, result: Run) -> None:
    """The same, but a run that failed before anything happened, as when a device is not there, leaves what an earlier
    one recorded. What takes long is announced: npz and Parquet of a long run are written at its end.
    """
    from cspdiag.runtime.kernel.signals import left_to_the_main_thread

    if result.outcome.exit_code and recording.is_empty and recording.problem is None:
        recording.discard()
        say(f"cspdiag: nothing was recorded, so {on_one_line(path)} was not written")
        raise _RecordingFailedError
    with left_to_the_main_thread():
        notice = Timer(_PATIENCE, say, [f"cspdiag: writing {on_one_line(path)}"])
        notice.daemon = True
        notice.start()
    try:
        _finish(recording, result)
    finally:
        notice.cancel()


def _write(requested: deque[tuple[Path | str, _Writer]]) -> list[Path | str]:
    """Write the files, and remove each from ``requested`` then; returns the paths that cannot be written, which do not
    prevent the others.
    """
    missing = []
    while requested:
        path, writer = requested[0]
        try:
            writer(path)
        except _RecordingFailedError:
            missing.append(path)
        except OSError as problem:
            problem.filename = str(path)
            say(f"cspdiag: {described(problem)}")
            missing.append(path)
        requested.popleft()
    return missing


def _print_summary(arguments: Namespace, result: Run, checked: Checked, written: list[str]) -> None:
    from cspdiag.runtime.kernel.exceptions import described

    if arguments.quiet:
        for error in filter(None, (result.outcome.error, *result.outcome.release_errors)):
            say(f"cspdiag: {described(error)}")
        return
    say(result.summary())
    timeout = explained_timeout(result, checked.report.diagnostics)
    if timeout is not None:
        say(timeout)
    if written:
        say(f"  wrote {', '.join(map(on_one_line, written))}")
    if arguments.draw_deadlock is not None and result.outcome.deadlock is None:
        say(f"  no deadlock: {on_one_line(arguments.draw_deadlock)} was not written")


def _draw_deadlock(path: Path, result: Run, program: Program | None) -> None:
    from cspdiag.cli.support.deadlock_picture import write_picture
    from cspdiag.verify.deadlock_picture import deadlock_of

    assert result.outcome.deadlock is not None
    write_picture(path, deadlock_of(result.outcome.deadlock, result.network), program)
