"""Carries out a command of cspdiag in a process of its own, which may hang, print or fail as it likes."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

from cspdiag.base.record import record

LONGEST = 20_000
"""The number of characters of a text that is returned; an assistant could not read more."""
_LONGEST_END = 10.0
"""Seconds in which all commands end that were asked to."""
_TIME_TO_REPORT = 8.0
"""Seconds in which a command that took too long says how far it came; on a busy machine it needs several."""
PATIENCE = 30.0
"""Seconds that a command may take beyond the time that it was given."""


_PROGRAM = (
    "import sys; from cspdiag.base.parent import end_with_input; end_with_input(); "
    "from cspdiag.__main__ import main; sys.exit(main())"
)
_waiting: set[asyncio.Task[object]] = set()
"""The tasks that wait for a command."""


@record
class Finished:
    """What a command returned; ``code`` is None if it was ended because it took too long."""

    code: int | None
    out: str
    err: str


async def command(folder: Path, *arguments: str, seconds: float) -> Finished:
    """Run ``cspdiag`` with some arguments in a folder, for at most ``seconds``. It does not outlive this process."""
    task = asyncio.current_task()
    assert task is not None
    _waiting.add(task)
    task.add_done_callback(_waiting.discard)
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-c",
        _PROGRAM,
        *arguments,
        cwd=folder,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
        start_new_session=True,
        env={**os.environ, "NO_COLOR": "1", "COLUMNS": "120"},
    )
    communication = asyncio.ensure_future(_output(process))
    try:
        out, err = await asyncio.wait_for(asyncio.shield(communication), seconds)
        code = process.returncode
    except TimeoutError:
        # Ctrl-C first: a run then releases its outputs and reports how far it came.
        out, err = await _ended(process, communication)
        code = None
    except asyncio.CancelledError:
        await _ended(process, communication)
        raise
    return Finished(code, out.decode(errors="replace"), err.decode(errors="replace"))


async def _output(process: asyncio.subprocess.Process) -> tuple[bytes, bytes]:
    """What the process writes until it ends. Its standard input stays open until then."""
    assert process.stdout is not None
    assert process.stderr is not None
    out, err = await asyncio.gather(process.stdout.read(), process.stderr.read())
    await process.wait()
    return out, err


async def end_all() -> None:
    """End all commands, as by Ctrl-C, and wait until those who wait for them have put away what they left."""
    tasks = list(_waiting)
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.wait(tasks, timeout=_LONGEST_END)


async def _ended(
    process: asyncio.subprocess.Process, communication: asyncio.Future[tuple[bytes, bytes]]
) -> tuple[bytes, bytes]:
    for number, patience in ((signal.SIGINT, _TIME_TO_REPORT), (signal.SIGKILL, None)):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(asyncio.TimeoutError):
            return await asyncio.wait_for(asyncio.shield(communication), patience)
    raise AssertionError


def shortened(text: str) -> str:
    """The text, or its beginning and end, and how much is left out."""
    if len(text) <= LONGEST:
        return text
    half = LONGEST // 2
    return f"{text[:half]}\n... {len(text) - LONGEST:,} characters left out ...\n{text[-half:]}"
