"""A command is answered, once, whatever its server does."""

from __future__ import annotations

import os
import signal
import socket
from collections.abc import Iterator

import pytest

from cspdiag.cli.server import messages
from tests.cli.conftest import GOOD
from tests.cli.server.commands import Answer, Place, served

FINE = Answer(0, b"", b"checked 1 file: no errors\n")


@pytest.fixture
def listener(alone: Place) -> Iterator[socket.socket]:
    """The socket of a server that the test plays; the commands cannot start another one."""
    (alone.programs / "good.csp").write_text(GOOD)
    with served(alone):
        (name,) = [file.name for file in (alone.sockets / "cspdiag").iterdir() if file.suffix != ".lock"]
    folder = alone.sockets / "cspdiag"
    folder.mkdir(mode=0o700)
    here = os.getcwd()
    os.chdir(folder)
    with socket.socket(socket.AF_UNIX) as made:
        try:
            made.bind(name)
        finally:
            os.chdir(here)
        made.listen()
        made.settimeout(60)
        # A server takes the place only if it can lock it.
        (folder / f"{name}.lock").mkdir()
        yield made


def talk(alone: Place, listener: socket.socket, *replies: bytes) -> Answer:
    """The answer of a command whose server gives these replies and closes the connection."""
    process = alone.start("--server", "good.csp")
    connection, _ = listener.accept()
    connection.settimeout(60)
    assert messages.receive(connection)[0] == messages.CHECK
    for reply in replies:
        connection.sendall(reply)
        if reply == messages.READY:
            files = messages.receive_go(connection)
            assert len(files) == 4
            for file in files:
                os.close(file)
    connection.close()
    out, err = process.communicate(timeout=60)
    return Answer(process.returncode, out, err)


@pytest.mark.parametrize("replies", [[], [b"?"], [messages.READY]], ids=str)
def test_a_server_that_ends_before_it_has_done_anything(
    alone: Place, listener: socket.socket, replies: list[bytes]
) -> None:
    assert talk(alone, listener, *replies) == FINE


def test_a_server_that_ends_when_it_may_have_written_something(alone: Place, listener: socket.socket) -> None:
    answer = talk(alone, listener, messages.READY, messages.TOUCHED)
    assert answer == Answer(3, b"", b"cspdiag: the server was ended before it had finished\n")


def test_a_server_that_does_not_answer(alone: Place, listener: socket.socket) -> None:
    assert alone.check("--server", "good.csp") == FINE


def test_the_exit_code_is_that_of_the_server(alone: Place, listener: socket.socket) -> None:
    replies = (messages.READY, messages.TOUCHED, messages.END + b"\x07")
    assert talk(alone, listener, *replies) == Answer(7, b"", b"")


def test_a_suspended_server_is_not_reported_as_missing(alone: Place) -> None:
    with served(alone):
        process = alone.server()
        os.kill(process, signal.SIGSTOP)
        try:
            silent = Answer(1, f"server {process} does not answer (kill -9 {process} ends it)\n".encode(), b"")
            assert alone.check("--server-status") == silent
            assert alone.check("--server-stop") == silent
        finally:
            os.kill(process, signal.SIGCONT)
