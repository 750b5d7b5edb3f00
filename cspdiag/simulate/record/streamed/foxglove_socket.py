"""Shows what is recorded to Foxglove and PlotJuggler while the run continues, over a WebSocket.

The server is that of foxglove-sdk, in threads of its own: it never waits for a client. A slow one misses the oldest
messages that wait for it; one that goes away is forgotten; while nobody has subscribed to a port, nothing is encoded.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from cspdiag.base.errors import missing_package
from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.client_faults import ClientFaults
from cspdiag.simulate.record.streamed.mcap.messages import encoded, message_of, topics

_BACKLOG = 1 << 16
"""The most messages that wait for a client."""
_LAST = 0.2
"""Seconds at the end in which clients can take what they have not taken yet."""

_PATIENCE = 1.0
"""Seconds that the server has for its end."""


class FoxgloveSocket:
    """A server for the ports of one run; ``port`` is the number that it has, also if 0 was asked for. ``say`` is
    called, in any thread, with the faults of clients.
    """

    def __init__(self, head: RecordingHead, host: str, port: int, say: Callable[[str], object]) -> None:
        """Raises MissingPackageError, and OSError or RuntimeError if it cannot listen there."""
        try:
            import foxglove
        except ImportError:
            raise missing_package("foxglove-sdk", "serve") from None
        self._subscriptions: dict[str, int] = {}
        self._lock = threading.Lock()
        # Its channels last as long as it is kept.
        self._context = context = foxglove.Context()
        self._messages = [message_of(each.type) for each in head.ports]
        self._types = [each.type for each in head.ports]
        self._topics = topics([each.name for each in head.ports])
        self._server: Any = foxglove.start_server(
            name=f"{head.process} in {head.environment}",
            host=host,
            port=port,
            server_listener=_Listener(self),  # type: ignore[arg-type]
            context=context,
            message_backlog_size=_BACKLOG,
        )
        self._channels: list[Any] = [
            foxglove.Channel(
                topic,
                schema=foxglove.Schema(name=message.name, encoding="ros2msg", data=message.definition.encode()),
                message_encoding="cdr",
                metadata={
                    "port": each.name,
                    "type": str(each.type),
                    "unit": ", ".join(dict.fromkeys(each.units.values())),
                },
                context=context,
            )
            for each, message, topic in zip(head.ports, self._messages, self._topics, strict=True)
        ]
        self.port = int(self._server.port)
        self._faults = ClientFaults(say)
        self._faults.begin()

    def subscribed(self, topic: str, change: int) -> None:
        """A client has subscribed to a topic (1), or does not want it any more (-1)."""
        with self._lock:
            self._subscriptions[topic] = self._subscriptions.get(topic, 0) + change

    def show(self, blocks: Sequence[Block]) -> None:
        """See ``Listener.show``."""
        wanted = [block for block in blocks if self._subscriptions.get(self._topics[block.port], 0) > 0]
        messages = []
        for block in wanted:
            rows = encoded(self._messages[block.port], block.value, self._types[block.port])
            log = self._channels[block.port].log
            messages += [(instant, log, row.tobytes()) for instant, row in zip(block.time.tolist(), rows, strict=True)]
        messages.sort(key=lambda message: message[0])
        for instant, log, data in messages:
            log(data, log_time=instant)

    def close(self) -> None:
        """The run is over: clients get what they have not got yet, and are disconnected."""
        if any(count > 0 for count in self._subscriptions.values()):
            time.sleep(_LAST)
        # It would wait forever for a client that has connected and says nothing.
        stopping = threading.Thread(target=self._server.stop, name="socket", daemon=True)
        stopping.start()
        stopping.join(_PATIENCE)
        self._faults.finish()


class _Listener:
    """Notes who wants what, called by the server in its threads."""

    def __init__(self, socket: FoxgloveSocket) -> None:
        self._socket = socket

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """See ``foxglove.websocket.ServerListener``."""
        self._socket.subscribed(channel.topic, 1)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """See ``foxglove.websocket.ServerListener``; it is also called when a client disconnects."""
        self._socket.subscribed(channel.topic, -1)
