"""Runs the server until a signal ends it."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path

import uvicorn
from starlette.applications import Starlette

from cspdiag.studio.engine.program_file import ProgramFile
from cspdiag.studio.server.access import Access, SingleUse, new_token
from cspdiag.studio.server.application import application
from cspdiag.studio.server.engines import ENGINE
from cspdiag.studio.server.room import Room
from cspdiag.studio.server.saved_files import SavedFiles

LONGEST_MESSAGE = 4 * 1024 * 1024
"""Bytes of a message of a page; a longer one ends its connection."""

_SECONDS_BETWEEN_PINGS = 2.0
_SECONDS_FOR_PONG = 4.0
"""A page whose network is gone does not say so; six seconds after that, its program is stopped."""


class StudioServer(uvicorn.Server):
    """Ends the engines of its room before it ends."""

    def __init__(self, application: Starlette, room: Room, on_start: Callable[[], None]) -> None:
        super().__init__(
            uvicorn.Config(
                application,
                access_log=False,
                log_level="error",
                ws="websockets-sansio",
                ws_max_size=LONGEST_MESSAGE,
                ws_ping_interval=_SECONDS_BETWEEN_PINGS,
                ws_ping_timeout=_SECONDS_FOR_PONG,
                timeout_graceful_shutdown=5,
                lifespan="off",
            )
        )
        self._room = room
        self._on_start = on_start

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin, and say so."""
        await super().startup(sockets)
        if self.started:
            self._on_start()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End, the running program first."""
        await self._room.close()
        await super().shutdown(sockets)


def serve(file: Path, page: Path, port: int, on_start: Callable[[str, str], None]) -> None:
    """Serve the program in ``file`` until a signal, which the process then gets once more. When pages can be opened,
    ``on_start`` is given the link, and one for a browser that can be used once. Port 0 is any that is free. Raises
    OSError if the port is taken.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
        first = SingleUse()
        access = Access(listener.getsockname()[1], new_token())
        room = Room((*ENGINE, str(file)), SavedFiles(ProgramFile(str(file))))
        answering = application(room, access, first, page)
        origin = f"http://127.0.0.1:{access.port}"
        links = f"{origin}/?token={access.token}", f"{origin}/open?once={first.code}"
        StudioServer(answering, room, lambda: on_start(*links)).run(sockets=[listener])
