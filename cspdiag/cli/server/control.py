"""What people ask servers: whether they run, and to stop."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

from cspdiag.cli.server import messages, place
from cspdiag.cli.server.seat import LOCK, is_taken
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL
from cspdiag.cli.support.terminal import write_out

_PATIENCE = 5.0
"""How long to wait for an answer, and for a server to end, in seconds."""


class _SilentError(Exception):
    """A server is there, but does not answer: ``process`` is its number."""

    def __init__(self, process: int) -> None:
        super().__init__(f"server {process} does not answer")
        self.process = process


def show_status() -> int:
    """Show the servers of this user; UNSUCCESSFUL if none is running, or one does not answer."""
    return _report(messages.STATUS, lambda name, answer: _line(answer))


def stop() -> int:
    """Stop all servers of this user, and wait until they have gone. Commands that they carry out are finished.
    UNSUCCESSFUL if one does not answer.
    """
    return _report(messages.STOP, _stopped)


def _stopped(name: str, answer: dict[str, Any]) -> str:
    if not _is_gone(name):
        raise _SilentError(answer["process"])
    return f"server {answer['process']} has stopped"


def _report(question: str, shown: Callable[[str, dict[str, Any]], str]) -> int:
    """Ask all servers, and show what they answer."""
    lines = []
    code = FINE
    for name in _names():
        try:
            answer = _asked(name, question)
            if answer is not None:
                lines.append(shown(name, answer))
        except _SilentError as silent:
            lines.append(f"{silent} (kill -9 {silent.process} ends it)")
            code = UNSUCCESSFUL
    write_out("".join(f"{line}\n" for line in lines or ["no server is running"]))
    return code if lines or question == messages.STOP else UNSUCCESSFUL


def _names() -> list[str]:
    """The names of all sockets, also of servers that are starting: one that has its place will soon listen there."""
    deadline = time.monotonic() + _PATIENCE
    while time.monotonic() < deadline:
        files = set(_files())
        places = {name.removesuffix(LOCK) for name in files if name.endswith(LOCK)}
        if not any(is_taken(name) for name in places - files):
            break
        time.sleep(0.005)
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
    """The answer of a server, or None if it is gone, or has left its socket. Raises _SilentError."""
    try:
        connection = place.connect(name)
    except OSError:
        return None
    try:
        connection.settimeout(_PATIENCE)
        messages.send(connection, [question])
        answer = messages.receive(connection)
    except TimeoutError:
        raise _SilentError(place.peer(connection)[0]) from None
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
