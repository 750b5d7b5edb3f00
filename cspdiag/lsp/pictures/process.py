"""The process that draws: the editor is answered meanwhile, and the layout engine is loaded once."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from cspdiag.base.errors import CspdiagError

_PROGRAM = (
    "import json, sys; sys.path[:] = json.loads(sys.stdin.readline()); "
    "from cspdiag.lsp.pictures.drawn import serve; serve()"
)
_LONGEST_LINE = 1 << 30
"""Bytes of an answer."""
TIME_LIMIT = 20.0
"""Seconds for one picture, so that it does not keep others waiting."""


class DrawingError(CspdiagError):
    """Nothing can be drawn; the text says why."""


class Drawer:
    """Draws one picture after the other, in a process that starts with the first and ends with the server.

    Of several requests that wait under one name only the latest is drawn. A picture that takes longer than
    ``time_limit`` seconds is given up.
    """

    def __init__(self, time_limit: float = TIME_LIMIT) -> None:
        self._time_limit = time_limit
        self._process: asyncio.subprocess.Process | None = None
        self._lock = asyncio.Lock()
        self._latest: dict[str, int] = {}
        self.drawn = 0
        """How many pictures were drawn."""

    async def draw(self, name: str, request: Mapping[str, object]) -> dict[str, Any] | None:
        """The answer of ``cspdiag.lsp.pictures.drawn``; None if there is a later request under this name.

        Raises DrawingError if the process ends, or takes too long.
        """
        number = self._latest[name] = self._latest.get(name, 0) + 1
        # An exchange that has begun is finished, also if the editor no longer waits for it: answers have no names.
        return await asyncio.shield(asyncio.ensure_future(self._when_free(name, number, request)))

    async def close(self) -> None:
        """End the process; it ends with the server in any case."""
        process, self._process = self._process, None
        if process is not None and process.stdin is not None:
            process.stdin.close()
            await process.wait()

    async def _when_free(self, name: str, number: int, request: Mapping[str, object]) -> dict[str, Any] | None:
        async with self._lock:
            if self._latest[name] != number:
                return None
            del self._latest[name]
            return await self._exchange(request)

    async def _exchange(self, request: Mapping[str, object]) -> dict[str, Any]:
        self.drawn += 1
        process = self._process
        if process is None or process.returncode is not None:
            process = self._process = await self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        line = b""
        try:
            async with asyncio.timeout(self._time_limit):
                process.stdin.write(json.dumps(request).encode() + b"\n")
                await process.stdin.drain()
                line = await process.stdout.readline()
        except ConnectionError:
            pass  # It has ended.
        except TimeoutError:
            self._process = None
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
            raise DrawingError(f"it is too large: it was not drawn within {self._time_limit:g} s") from None
        if not line.endswith(b"\n"):
            self._process = None
            raise DrawingError("the process that draws has ended; its messages are in the log of the server")
        answer: dict[str, Any] = json.loads(line)
        return answer

    async def _start(self) -> asyncio.subprocess.Process:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-c",
            _PROGRAM,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            limit=_LONGEST_LINE,
        )
        assert process.stdin is not None
        process.stdin.write(json.dumps(sys.path).encode() + b"\n")
        return process
