"""What a page has not seen waits at the server, so that little is on its way to a page that is slow."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from cspdiag.studio.server.viewer import Viewer


class _Connection:
    def __init__(self) -> None:
        self.sent: list[dict[str, Any]] = []
        self.lengths: list[int] = []

    async def send_text(self, data: str) -> None:
        self.sent.append(json.loads(data))
        self.lengths.append(len(data))


async def _quiet() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


def _frame(number: int) -> dict[str, Any]:
    """A frame of 120 signals, which has 17 values of each."""
    times = [1_000_000 * (17 * number + tick) for tick in range(17)]
    signals = {f"s{name}": {"t": times, "v": [tick / 3 for tick in times]} for name in range(120)}
    return {"session": 1, "from": times[0], "to": times[-1], "signals": signals}


def _send(viewer: Viewer, number: int) -> None:
    frame = _frame(number)
    viewer.send_frame(json.dumps({"method": "frame", "params": frame}), frame)


def test_little_is_on_its_way_to_a_page_that_sees_nothing() -> None:
    async def run() -> None:
        connection = _Connection()
        viewer = Viewer(connection)
        sending = asyncio.create_task(viewer.send_all())
        for number in range(300):
            _send(viewer, number)
            await _quiet()
        on_the_way = len(connection.sent)
        assert on_the_way == 6
        assert viewer.waiting <= 3

        # When it sees again, it gets what it has missed, in few messages, each of bounded length.
        viewer.send({"method": "ended"})
        while len(connection.sent) < on_the_way + 4:
            viewer.seen()
            await _quiet()
        sending.cancel()
        assert max(connection.lengths) < 2 * 1024 * 1024
        frames = [message["params"] for message in connection.sent[:-1]]
        assert [frame["from"] for frame in frames[1:]] == [frame["to"] + 1_000_000 for frame in frames[:-1]]
        assert frames[-1]["to"] == _frame(299)["to"]
        assert frames[-1]["signals"]["s0"]["t"][-1] == frames[-1]["to"]
        assert connection.sent[-1] == {"method": "ended"}

    asyncio.run(run())


def test_a_page_that_says_that_it_has_seen_more_than_it_was_sent_gains_nothing() -> None:
    async def run() -> None:
        connection = _Connection()
        viewer = Viewer(connection)
        sending = asyncio.create_task(viewer.send_all())
        for _ in range(1000):
            viewer.seen()
        for number in range(300):
            _send(viewer, number)
            await _quiet()
        sending.cancel()
        assert len(connection.sent) == 6

    asyncio.run(run())
