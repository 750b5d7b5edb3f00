"""``python -m cspdiag.studio.engine [FILE]``: the engine on standard input and output, one message a line, as JSON.

A session ends, and the outputs of its program are released, when the input ends or a signal arrives.
"""

from __future__ import annotations

import json
import signal
import sys
import threading
from queue import Empty, SimpleQueue
from types import FrameType
from typing import Any

from cspdiag.studio.engine.engine import Engine
from cspdiag.studio.engine.program_file import ProgramFile


def main(arguments: list[str]) -> int:
    """Answer requests until the input ends."""
    output = sys.stdout
    # Whatever a program prints does not belong to an answer.
    sys.stdout = sys.stderr

    def send(message: dict[str, Any]) -> None:
        output.write(json.dumps(message, allow_nan=False) + "\n")
        output.flush()

    engine = Engine(send, file=ProgramFile(arguments[0]) if arguments else None)
    lines: SimpleQueue[str | None] = SimpleQueue()
    threading.Thread(target=_read, args=(lines,), name="requests", daemon=True).start()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end)
    try:
        _serve(engine, lines, send)
    except BrokenPipeError:
        pass  # Nobody listens any more.
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        engine.close()
    return 0


def _serve(engine: Engine, lines: SimpleQueue[str | None], send: Any) -> None:
    while True:
        try:
            line = lines.get(timeout=engine.due())
        except Empty:
            engine.proceed()
            continue
        if line is None:
            return
        if line.strip():
            send(engine.request(_message(line)))
        engine.proceed()


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
