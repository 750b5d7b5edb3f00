"""The server: waits for commands, forks a process for each, and learns the programs that they have checked.

It ends after ten minutes without a command, when its code has changed, or when it is asked to.
"""

from __future__ import annotations

import gc
import marshal
import os
import select
import signal
import socket
import sys
import time
from contextlib import suppress
from typing import NoReturn

from cspdiag import __version__
from cspdiag.base.record import record
from cspdiag.cli.server import place
from cspdiag.cli.server.code import Code
from cspdiag.cli.server.memory import Memory, Use, remember
from cspdiag.cli.server.practice import practise
from cspdiag.cli.server.request import LEAVE, USED, carry_out
from cspdiag.cli.server.seat import seat

IDLE = 600.0
"""How long a server waits for the next command, in seconds."""
_QUIET = 0.02
"""For how long no command must have come before the server learns, in seconds."""
_MOST = 32
"""How many commands are carried out at the same time."""
_LONGEST = 0.25
"""A program that took longer, in seconds of processor time, is not learned: a command would have to wait meanwhile."""


def serve(name: str, idle: float = IDLE) -> None:
    """Be the server of a name until it is not needed any more; return at once if there is one already."""
    _let_go()
    code = Code()
    if place.name_of(place.identity()) != name:
        # The interpreter has found other settings than those of the command.
        return
    with suppress(OSError), seat(name) as taken:
        if taken is None:
            return
        gc.disable()
        memory = Memory()
        practise()
        code.keep_loaded_layers()
        gc.collect()
        gc.freeze()
        remember(memory)
        with taken.listen() as listener:
            _Server(listener, code, memory, idle).run()


def _let_go() -> None:
    """Keep nothing of the process that has started this one, and leave the place as it should if asked to end."""
    os.chdir("/")
    os.umask(0o077)
    for file in os.listdir("/proc/self/fd"):
        if int(file) > 2:
            with suppress(OSError):
                os.close(int(file))
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    for end in (signal.SIGINT, signal.SIGTERM):
        signal.signal(end, _end)


def _end(*_: object) -> NoReturn:
    sys.exit()


@record
class _Command:
    """A command that is being carried out: its process, and what that has said."""

    process: int
    said: bytearray


class _Server:
    def __init__(self, listener: socket.socket, code: Code, memory: Memory, idle: float) -> None:
        self._listener = listener
        self._code = code
        self._memory = memory
        self._idle = idle
        self._poll = select.poll()
        self._commands: dict[int, _Command] = {}
        """By the number of the pipe from the process."""
        self._unlearned: dict[str, Use] = {}
        """By the name of the main file: only its latest text is learned."""
        self._began = time.monotonic()
        self._count = 0
        self._leaves = False

    def run(self) -> None:
        """Serve until there is a reason to leave."""
        self._poll.register(self._listener, select.POLLIN)
        while not self._leaves:
            ready = self._poll.poll(self._patience())
            for file, _ in ready:
                if file == self._listener.fileno():
                    self._accept()
                else:
                    self._hear(file)
            if not ready and self._unlearned:
                self._learn()
            elif not ready:
                return

    def _patience(self) -> float | None:
        """How long to wait for something to happen, in milliseconds."""
        if self._commands:
            return None
        return 1000 * (_QUIET if self._unlearned else self._idle)

    def _accept(self) -> None:
        connection, _ = self._listener.accept()
        with connection:
            if not place.is_of_this_user(connection):
                return
            ours, theirs = os.pipe()
            try:
                process = os.fork()
            except OSError:
                os.close(ours)
            else:
                if process == 0:
                    self._carry_out(connection, theirs, ours)
                self._commands[ours] = _Command(process, bytearray())
                self._poll.register(ours, select.POLLIN)
                if len(self._commands) == _MOST:
                    self._poll.unregister(self._listener)
            os.close(theirs)

    def _carry_out(self, connection: socket.socket, to_server: int, from_process: int) -> NoReturn:
        """Be the process that carries out a command."""
        try:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            for kind in (signal.SIGTERM, signal.SIGHUP):
                signal.signal(kind, signal.SIG_DFL)
            self._listener.close()
            for file in (from_process, *self._commands):
                os.close(file)
            carry_out(connection, to_server, self._code, self._memory, self._status())
        finally:
            # Whatever went wrong, the command notices that the connection is closed.
            os._exit(0)

    def _status(self) -> dict[str, object]:
        return {
            "process": os.getppid(),
            "version": __version__,
            "seconds": time.monotonic() - self._began,
            "commands": self._count,
        }

    def _hear(self, file: int) -> None:
        """What the process of a command says, until it ends."""
        command = self._commands[file]
        data = os.read(file, 1 << 20)
        if data:
            command.said.extend(data)
            return
        self._poll.unregister(file)
        os.close(file)
        del self._commands[file]
        self._poll.register(self._listener, select.POLLIN)
        _, _, used = os.wait4(command.process, 0)
        said = bytes(command.said)
        if said == LEAVE:
            self._leaves = True
        if not said.startswith(USED):
            return
        self._count += 1
        if used.ru_utime + used.ru_stime <= _LONGEST:
            with suppress(EOFError, ValueError):
                for main, imported in marshal.loads(said[len(USED) :]):
                    self._unlearned[main[0]] = Use(main, imported)

    def _learn(self) -> None:
        """Check one program again, to know it if it comes again."""
        use = self._unlearned.pop(next(iter(self._unlearned)))
        # The command has said what is wrong, even with the compiler.
        with suppress(Exception):
            if not self._memory.learn(use):
                return
        gc.collect()
