"""A server with scripted engines, and pages that are connected to it."""

from __future__ import annotations

import json
import socket
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("uvicorn")
client = pytest.importorskip("websockets.sync.client")

from cspdiag.studio.engine.program_file import ProgramFile  # noqa: E402
from cspdiag.studio.server.access import Access, SingleUse  # noqa: E402
from cspdiag.studio.server.application import application  # noqa: E402
from cspdiag.studio.server.room import Room  # noqa: E402
from cspdiag.studio.server.saved_files import SavedFiles  # noqa: E402
from cspdiag.studio.server.serving import StudioServer  # noqa: E402

SEEN = '{"method": "seen"}'
ENGINE = Path(__file__).with_name("scripted_engine.py")


class Page:
    """A page that is connected."""

    def __init__(self, link: str, **options: Any) -> None:
        self._connection = client.connect(link, max_size=None, close_timeout=1, **options)
        self.socket = self._connection.__enter__()
        self.notifications: list[dict[str, Any]] = []
        self._requests = 0

    def close(self) -> None:
        """The page is closed."""
        self._connection.__exit__(None, None, None)

    def ask(self, method: str, **params: Any) -> Any:
        """The result; raises RuntimeError for an error."""
        self._requests += 1
        self.socket.send(json.dumps({"id": self._requests, "method": method, "params": params}))
        while True:
            message = self.receive()
            if message.get("id") == self._requests:
                if "error" in message:
                    raise RuntimeError(message["error"]["message"])
                return message["result"]

    def receive(self, timeout: float = 20) -> dict[str, Any]:
        """The next message; notifications are kept, too."""
        message: dict[str, Any] = json.loads(self.socket.recv(timeout))
        if "method" in message:
            self.notifications.append(message)
        if message.get("method") == "frame":
            self.socket.send(SEEN)
        return message

    def wait_for(self, method: str) -> Any:
        """The parameters of the next notification of a method."""
        while True:
            message = self.receive()
            if message.get("method") == method:
                return message["params"]


class Studio:
    """A server in a thread of its own."""

    def __init__(self, folder: Path) -> None:
        self.program = folder / "a.csp"
        self.program.write_text("process A() = SKIP\n", encoding="utf-8")
        page = folder / "page"
        page.mkdir()
        (page / "index.html").write_text("<p>the page</p>", encoding="utf-8")
        self._listener = socket.socket()
        self._listener.bind(("127.0.0.1", 0))
        self.access = Access(self._listener.getsockname()[1], "the token")
        self.first = SingleUse()
        saved = SavedFiles(ProgramFile(str(self.program)))
        self.room = Room([sys.executable, str(ENGINE), str(self.program)], saved)
        answering = application(self.room, self.access, self.first, page)
        self.server = StudioServer(answering, self.room, lambda: None)
        self._thread = threading.Thread(target=lambda: self.server.run(sockets=[self._listener]))
        self._thread.start()
        while not self.server.started:
            time.sleep(0.01)
        self._pages: list[Page] = []

    @property
    def link(self) -> str:
        return f"ws://127.0.0.1:{self.access.port}/engine?token=the%20token"

    def open(self, **options: Any) -> Page:
        page = Page(self.link, **options)
        self._pages.append(page)
        return page

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self) -> None:
        """End the server, as a signal does."""
        for page in self._pages:
            page.close()
        self.server.should_exit = True
        self._thread.join()
        self._listener.close()

    @property
    def released(self) -> bool:
        """Whether the engine of a session has ended as it should."""
        return Path(f"{self.program}.released").exists()
