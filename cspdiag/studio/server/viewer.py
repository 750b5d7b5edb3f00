"""A page that is open, and what waits to be sent to it."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from typing import Any, Protocol

from cspdiag.studio.server.frames import Frame, merged

_FRAMES_AHEAD = 3
"""Frames that may wait as they are; further ones are merged into the last, so that what waits is bounded."""
_MOST_UNSEEN = 6
"""Frames that a page was sent and has not seen yet. What is beyond waits here, where it can be merged, and not in the
buffers of the connection, where pings would wait behind it until the page is considered lost.
"""


class Connection(Protocol):
    """A WebSocket."""

    async def send_text(self, data: str) -> None:
        """Send a message; waits while the page is slow. Raises when the connection is lost."""
        ...


class Viewer:
    """Sends messages in their order, in a task of its own: nobody waits for a page that is slow."""

    page = 0
    """Its number among the pages that were opened since the server began, from 1."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._waiting: deque[tuple[str, Frame | None]] = deque()
        """Texts of messages; a frame that was merged has none."""
        self._frames = 0
        self._unseen = 0
        """Frames that were sent and not seen yet."""
        self._news = asyncio.Event()
        self.pending = 0
        """Requests that are not answered yet."""

    @property
    def waiting(self) -> int:
        """Messages that are not sent yet."""
        return len(self._waiting)

    def send(self, message: dict[str, Any] | str) -> None:
        """Send a message, or the text of one."""
        self._waiting.append((message if isinstance(message, str) else json.dumps(message), None))
        self._news.set()

    def send_frame(self, text: str, frame: Frame) -> None:
        """Send a frame, whose notification is ``text``, or merge it into the last one that waits."""
        last = self._waiting[-1][1] if self._waiting else None
        if self._frames >= _FRAMES_AHEAD and last is not None and last["session"] == frame["session"]:
            self._waiting[-1] = "", merged(last, frame)
        else:
            self._waiting.append((text, frame))
            self._frames += 1
        self._news.set()

    def seen(self) -> None:
        """The page has seen a frame."""
        if self._unseen:
            self._unseen -= 1
            self._news.set()

    async def send_all(self) -> None:
        """Send what there is and will be, until it is cancelled or the connection is lost."""
        while True:
            while self._waiting and not self._must_wait(self._waiting[0][1]):
                text, frame = self._waiting.popleft()
                if frame is not None:
                    self._frames -= 1
                    text = text or json.dumps({"method": "frame", "params": frame})
                    self._unseen += 1
                await self._connection.send_text(text)
            self._news.clear()
            await self._news.wait()

    def _must_wait(self, frame: Frame | None) -> bool:
        return frame is not None and self._unseen >= _MOST_UNSEEN
