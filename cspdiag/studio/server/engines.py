"""Engines that work for the server, each in a process of its own: one may compute for minutes, or be ended."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, Final

from cspdiag.base.errors import CspdiagError, file_error
from cspdiag.studio.server.terminal import LentTerminal

MOST_BYTES: Final = 256 * 1024 * 1024
"""Of one message of an engine: the recording of a long run."""

_PATIENCE = 3.0
"""Seconds in which an engine is to release the outputs of its program and to end."""


class EngineGoneError(CspdiagError):
    """The engine has ended before it answered."""


class EngineNotStartedError(CspdiagError):
    """There is no process for the engine; the text says why."""


class EngineProcess:
    """An engine that is asked by ``request`` and reports each notification to ``on_notification``, as text.

    ``on_end`` is called if it ends by itself, and begins again when it is asked. One that ``uses_terminal`` has that of
    the server for the programs that it runs.
    """

    def __init__(
        self,
        command: Sequence[str],
        folder: str,
        on_notification: Callable[[str, dict[str, Any]], None] = lambda text, message: None,
        on_end: Callable[[], None] = lambda: None,
        *,
        uses_terminal: bool = False,
    ) -> None:
        self._command = command
        self._folder = folder
        self._on_notification = on_notification
        self._on_end = on_end
        self._uses_terminal = uses_terminal
        self._process: Process | None = None
        self._reader: asyncio.Task[None] | None = None
        self._waiting: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._requests = 0
        self._starting = asyncio.Lock()

    @property
    def runs(self) -> bool:
        """Whether there is a process."""
        return self._process is not None

    async def request(self, method: str, params: object) -> dict[str, Any]:
        """The answer, with ``result`` or ``error``. Raises EngineGoneError, and EngineNotStartedError."""
        async with self._starting:
            process = self._process or await self._start()
        self._requests += 1
        number = self._requests
        answer: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()
        self._waiting[number] = answer
        try:
            assert process.stdin is not None
            process.stdin.write(json.dumps({"id": number, "method": method, "params": params}).encode() + b"\n")
            await process.stdin.drain()
            return await answer
        except (BrokenPipeError, ConnectionResetError):
            raise EngineGoneError from None
        finally:
            self._waiting.pop(number, None)

    async def _start(self) -> Process:
        terminal = LentTerminal() if self._uses_terminal else None
        try:
            process = await asyncio.create_subprocess_exec(
                *self._command,
                stdin=PIPE,
                stdout=PIPE,
                cwd=self._folder,
                limit=MOST_BYTES,
                start_new_session=True,  # What is typed to end the server is not for its engines, which it ends itself.
                env={**os.environ, **({} if terminal is None else terminal.variables)},
            )
        except OSError as problem:
            raise EngineNotStartedError(str(file_error(problem))) from None
        self._process = process
        self._reader = asyncio.create_task(self._read(process, terminal))
        return process

    async def _read(self, process: Process, terminal: LentTerminal | None) -> None:
        assert process.stdout is not None
        try:
            # A process that is killed may end in the middle of a message.
            while (line := await process.stdout.readline()).endswith(b"\n"):
                if self._take(line.decode()):
                    # Who waits for the answer passes it on before what the engine sent next.
                    await asyncio.sleep(0)
        except ValueError:  # A message that is too long.
            with suppress(ProcessLookupError):
                process.kill()
        finally:
            if self._process is process:
                self._process = None
                self._on_end()
            for answer in self._waiting.values():
                if not answer.done():
                    answer.set_exception(EngineGoneError())
            if await process.wait() < 0 and terminal is not None:
                terminal.restore()

    def _take(self, line: str) -> bool:
        """Pass a message on; whether it is an answer."""
        message = json.loads(line)
        if "id" not in message:
            self._on_notification(line, message)
            return False
        answer = self._waiting.get(message["id"])
        if answer is not None and not answer.done():
            answer.set_result(message)
        return True

    async def end(self) -> None:
        """End the process: its program releases its outputs when the input ends; by force if that takes too long."""
        process, self._process = self._process, None
        if process is None:
            return
        assert process.stdin is not None
        with suppress(BrokenPipeError, ConnectionResetError):
            process.stdin.close()
        for force in (process.terminate, process.kill):
            try:
                await asyncio.wait_for(process.wait(), _PATIENCE)
                break
            except TimeoutError:
                with suppress(ProcessLookupError):
                    force()
        await process.wait()
        if self._reader is not None:
            await self._reader


ENGINE: Final = (sys.executable, "-P", "-m", "cspdiag.studio.engine")
"""What starts an engine."""
