"""MQTT: topics of a broker, with paho-mqtt."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping, Sequence
from typing import Any

from .failure import DeviceError, library
from .messages import SECOND, MessageDevice, Use, addressed, decoded, encoded

_PATIENCE = 5.0
"""Seconds for the broker to answer, and to take the last values."""


class Mqtt(MessageDevice):
    """Topics of the broker at ``host``; payloads are JSON: ``0.5``, ``true``, ``[1, 2]``.

    The topic of a port is its ``PORT_topic``, by default its name after ``prefix``. The password of ``user`` is in the
    environment variable ``MQTT_PASSWORD``. What the broker has retained is a first sample, but no event.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        host: str = "localhost",
        port: int = 1883,
        prefix: str = "",
        qos: int = 0,
        tls: bool = False,
        user: str = "",
        patience: int = 10 * SECOND,
        timeout: int = 0,
        **topics: str,
    ) -> None:
        super().__init__(f"mqtt {host}:{port}", outputs, patience=patience, timeout=timeout)
        self._place = (host, port)
        self._qos = qos
        self._tls = tls
        self._user = user
        self._ports = {topic: name for name, topic in addressed(outputs, "topic", topics, prefix).items()}
        self._topics = addressed(inputs, "topic", topics, prefix)
        self._answered = threading.Event()
        self._refused = ""
        self._ending = False
        self._client: Any = None
        self._last: dict[str, Any] = {}

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        paho = library("paho.mqtt.client", "paho-mqtt", "mqtt")
        self._client = paho.Client(paho.CallbackAPIVersion.VERSION2)
        if self._user:
            self._client.username_pw_set(self._user, os.environ.get("MQTT_PASSWORD"))
        if self._tls:
            self._client.tls_set()
        self._client.on_connect = self._connected
        self._client.on_disconnect = self._disconnected
        self._client.on_message = self._arrived
        try:
            self._client.connect(*self._place)
        except OSError as error:
            raise DeviceError(f"there is no broker: {error.strerror or error}; start one, or correct `host`") from None
        self._client.loop_start()
        if not self._answered.wait(_PATIENCE):
            raise DeviceError(f"the broker has not answered within {_PATIENCE:g} s")
        if self._refused:
            raise DeviceError(f"the broker refuses: {self._refused}; see `user` and MQTT_PASSWORD")

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``: after the last values have gone out."""
        self._ending = True
        if self._client is None:
            return
        try:
            for sent in self._last.values():
                if self._client.is_connected():
                    sent.wait_for_publish(_PATIENCE)
        finally:
            self._client.disconnect()
            self._client.loop_stop()

    def _connected(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        if reason.is_failure:
            self._refused = str(reason)
        elif self._ports:
            client.subscribe([(topic, self._qos) for topic in self._ports])
        self._answered.set()

    def _disconnected(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        if not self._ending:
            self.fail(DeviceError(f"the broker has gone away ({reason}): start it, and the program again"))

    def _arrived(self, client: Any, data: Any, message: Any) -> None:
        port = self._ports.get(message.topic, message.topic)
        if not (message.retain and port in self.blocking):
            self.receive(port, decoded(message.payload))

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``."""
        self._last[port] = self._client.publish(self._topics[port], encoded(value), self._qos)
