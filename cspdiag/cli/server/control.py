"""What people ask servers: whether they run, and to stop."""

from __future__ import annotations

import os
import time
from typing import Any

from cspdiag.cli.server import messages, place
from cspdiag.cli.server.seat import LOCK
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL
from cspdiag.cli.support.terminal import write_out

_PATIENCE = 5.0
"""How long to wait for an answer, and for a server to end, in seconds."""


def show_status() -> int:
    """Show the servers of this user; UNSUCCESSFUL if none is running."""
    answers = [answer for name in _names() if (answer := _asked(name, messages.STATUS))]
    lines = [_line(answer) for answer in answers] or ["no server is running"]
    write_out("".join(f"{line}\n" for line in lines))
    return FINE if answers else UNSUCCESSFUL


def stop() -> int:
    """Stop all servers of this user, and wait until they have gone. Commands that they carry out are finished."""
    stopped = [answer for name in _names() if (answer := _asked(name, messages.STOP)) and _is_gone(name)]
    lines = [f"server {answer['process']} has stopped" for answer in stopped] or ["no server is running"]
    write_out("".join(f"{line}\n" for line in lines))
    return FINE


def _names() -> list[str]:
    """The names of all sockets."""
    return sorted(name for name in _files() if not name.endswith(LOCK))


def _files() -> list[str]:
    if not place.AVAILABLE:
        return []
    try:
        folder = place.open_folder()
    except OSError:
        return []
    try:
        return os.listdir(folder)
    finally:
        os.close(folder)


def _asked(name: str, question: str) -> dict[str, Any] | None:
    """The answer of a server, or None if it does not answer: it is gone, or has left its socket."""
    try:
        connection = place.connect(name)
    except OSError:
        return None
    try:
        connection.settimeout(_PATIENCE)
        messages.send(connection, [question])
        answer = messages.receive(connection)
    except (OSError, EOFError, ValueError):
        return None
    finally:
        connection.close()
    return answer if isinstance(answer, dict) else None


def _is_gone(name: str) -> bool:
    """Whether a server has removed its files, which it does at the very end."""
    deadline = time.monotonic() + _PATIENCE
    while time.monotonic() < deadline:
        if name + LOCK not in _files():
            return True
        time.sleep(0.005)
    return False


def _line(answer: dict[str, Any]) -> str:
    minutes, seconds = divmod(int(answer["seconds"]), 60)
    running = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    count = answer["commands"]
    commands = "1 command" if count == 1 else f"{count} commands"
    return f"server {answer['process']}: cspdiag {answer['version']}, running for {running}, {commands}"
