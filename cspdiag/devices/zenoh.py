"""Zenoh: keys of a network without a broker, with eclipse-zenoh."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

from .failure import DeviceError, library
from .messages import SECOND, MessageDevice, Use, addressed, decoded, encoded

_PATIENCE = 1.0
"""Seconds that the last values have to leave for the network."""


class Zenoh(MessageDevice):
    """Keys of the network that this peer finds by multicast, and by the endpoints ``connect`` and ``listen``, such as
    ``tcp/192.168.1.7:7447``; payloads are JSON: ``0.5``, ``true``, ``[1, 2]``.

    The key of a port is its ``PORT_key``, by default its name after ``prefix``.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        connect: str = "",
        listen: str = "",
        multicast: bool = True,
        prefix: str = "",
        patience: int = 10 * SECOND,
        timeout: int = 0,
        **keys: str,
    ) -> None:
        super().__init__(f"zenoh {connect or listen}".rstrip(), outputs, patience=patience, timeout=timeout)
        self._settings: dict[str, Any] = {"scouting/multicast/enabled": multicast}
        if connect:
            self._settings |= {"connect/endpoints": [connect], "connect/exit_on_failure": True}
            self._settings["connect/timeout_ms"] = 1000
        if listen:
            self._settings["listen/endpoints"] = [listen]
        self._ports = {key: name for name, key in addressed(outputs, "key", keys, prefix).items()}
        self._keys = addressed(inputs, "key", keys, prefix)
        self._session: Any = None

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        zenoh = library("zenoh", "eclipse-zenoh", "zenoh")
        config = zenoh.Config()
        try:
            for key, value in self._settings.items():
                config.insert_json5(key, json.dumps(value))
            self._session = zenoh.open(config)
            for key in self._ports:
                self._session.declare_subscriber(key, self._arrived)
        except zenoh.ZError as error:
            raise DeviceError(f"it cannot join the network: {str(error).partition(' at ')[0]}") from None

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``. Raises DeviceError if what was sent last could not leave."""
        if self._session is None:
            return
        # Over a link that takes nothing any more it waits for ten seconds, and then fails.
        closing = threading.Thread(target=self._close, name=f"closing {self.name}", daemon=True)
        closing.start()
        closing.join(_PATIENCE)
        if closing.is_alive():
            raise DeviceError(
                "the link is dead, so the last values may not have arrived: look at the network, and the peer"
            )

    def _close(self) -> None:
        with suppress(library("zenoh", "eclipse-zenoh", "zenoh").ZError):
            self._session.close()

    def _arrived(self, sample: Any) -> None:
        key = str(sample.key_expr)
        self.receive(self._ports.get(key, key), decoded(sample.payload.to_bytes()))

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``."""
        self._session.put(self._keys[port], encoded(value))
