"""``python -m cspdiag.studio.engine [FILE]``: the engine on standard input and output, one message a line, as JSON.

A session ends, and the outputs of its program are released, when the input ends or a signal arrives; in real time also
when nobody reads what it sends.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from queue import Empty, SimpleQueue
from types import FrameType
from typing import Any

from cspdiag.runtime.kernel.stopping import HandlerFailed
from cspdiag.studio.engine.data import Data
from cspdiag.studio.engine.engine import Engine
from cspdiag.studio.engine.output import Output
from cspdiag.studio.engine.program_file import ProgramFile

_LAST_WORDS = 1.0
"""Seconds in which the last messages are to be read."""


def main(arguments: list[str]) -> int:
    """Answer requests until the input ends."""
    output = Output(sys.stdout)
    # Whatever a program prints does not belong to an answer.
    sys.stdout = sys.stderr

    def notify(method: str, params: Callable[[], Data]) -> None:
        output.put(lambda: _text({"method": method, "params": params()}))

    engine = Engine(notify, file=ProgramFile(arguments[0]) if arguments else None)
    lines: SimpleQueue[str | None] = SimpleQueue()
    threading.Thread(target=_read, args=(lines,), name="requests", daemon=True).start()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end)
    try:
        _serve(engine, lines, output)
    except BrokenPipeError:
        pass  # Nobody listens any more.
    except HandlerFailed as failed:  # ``_end`` was called while a program ran in real time.
        raise failed.cause from None
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        with suppress(BrokenPipeError):
            engine.close()
            output.wait(_LAST_WORDS)
        if output.is_stuck:
            os._exit(1)  # Its thread cannot be ended otherwise.
    return 0


def _serve(engine: Engine, lines: SimpleQueue[str | None], output: Output) -> None:
    while not output.is_stuck:
        try:
            line = lines.get(timeout=engine.due())
        except Empty:
            pass
        else:
            if line is None:
                return
            if line.strip():
                output.put(partial(_text, engine.request(_message(line))))
        engine.proceed()
        if not engine.keeps_pace:
            output.wait()
    sys.stderr.write("cspdiag: nobody reads what the engine of the studio sends, so it has ended\n")


def _text(message: Data) -> str:
    return json.dumps(message, allow_nan=False) + "\n"


def _message(line: str) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


def _read(lines: SimpleQueue[str | None]) -> None:
    for line in sys.stdin:
        lines.put(line)
    lines.put(None)


def _end(number: int, frame: FrameType | None) -> None:
    raise SystemExit(128 + number)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
