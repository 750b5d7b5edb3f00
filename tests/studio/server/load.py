"""Twenty pages look at fifty signals at 1 kHz, and one of them reads slowly: ``python -m tests.studio.server.load``.

Prints each minute how many frames a second the pages got, and what memory the server takes. Fails if that grows.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import threading
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.studio.server.running_studio import SEEN, Studio

_WARM = 1
"""Minutes after which memory is to be flat."""


class Reader(threading.Thread):
    """A page that counts the frames that it gets."""

    def __init__(self, link: str, pause: float = 0.0) -> None:
        super().__init__(daemon=True)
        self._link = link
        self._pause = pause
        self.frames = 0

    def run(self) -> None:
        with connect(self._link, max_size=None, ping_interval=None, max_queue=2 if self._pause else 16) as socket:
            try:
                for message in socket:
                    if '"frame"' in message[:40]:
                        self.frames += 1
                        socket.send(SEEN)
                    time.sleep(self._pause)
            except ConnectionClosed:
                return


def serve() -> None:
    """The server, in a process whose memory is its own: prints its link, and ends with its input."""
    with TemporaryDirectory() as folder, Studio(Path(folder)) as studio:
        print(studio.link, flush=True)
        sys.stdin.read()


def measure(link: str, server: int, minutes: float, pages: int) -> int:
    """0 if all is well."""
    with ExitStack() as stack:
        hand = stack.enter_context(connect(link, max_size=None, close_timeout=1))
        for number, method in enumerate(("start", "play")):
            hand.send(json.dumps({"id": number, "method": method, "params": {"session": "1"}}))
        readers = [Reader(link) for _ in range(pages - 2)]
        slow = Reader(link, pause=0.5)
        for reader in (*readers, slow):
            reader.start()
        threading.Thread(target=_see_all, args=(hand,), daemon=True).start()
        begin = time.monotonic()
        memory: list[float] = []
        while time.monotonic() - begin < minutes * 60:
            before, moment = [reader.frames for reader in readers], time.monotonic()
            time.sleep(min(60, minutes * 60))
            seconds = time.monotonic() - moment
            rates = [(reader.frames - count) / seconds for reader, count in zip(readers, before, strict=True)]
            memory.append(_megabytes(server))
            print(
                f"{min(rates):.1f} to {max(rates):.1f} frames/s, {memory[-1]:.1f} MB; slow page: {slow.frames}",
                flush=True,
            )
    return int(len(memory) > _WARM + 1 and memory[-1] > 1.05 * memory[_WARM])


def _see_all(page: ClientConnection) -> None:
    with suppress(ConnectionClosed):
        for message in page:
            if '"frame"' in message[:40]:
                page.send(SEEN)


def _megabytes(process: int) -> float:
    for line in Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    raise LookupError(process)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--pages", type=int, default=20)
    parser.add_argument("--serve", action="store_true")
    arguments: Any = parser.parse_args()
    if arguments.serve:
        serve()
        return 0
    command = [sys.executable, "-m", __spec__.name, "--serve"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        return measure(server.stdout.readline().strip(), server.pid, arguments.minutes, arguments.pages)


if __name__ == "__main__":
    sys.exit(main())
