"""OPC UA: variables of a server, with asyncua."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from collections.abc import Coroutine, Mapping, Sequence
from contextlib import suppress
from typing import Any

from .failure import DeviceError, library
from .messages import MILLISECOND, SECOND, MessageDevice, Use, addressed

_PATIENCE = 5.0
"""Seconds for the server to answer."""

_MISSING = ("BadNodeIdUnknown", "BadNodeIdInvalid", "BadAttributeIdInvalid")
"""Statuses that say that the server lacks a variable."""


class Opcua(MessageDevice):
    """Variables of the server at ``url``: each port has a ``PORT_node``, such as ``ns=2;s=Level``.

    The server reports changes every ``interval`` at most. The value that a variable has at the beginning is a sample,
    but no event. The password of ``user`` is in the environment variable ``OPCUA_PASSWORD``.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        url: str = "opc.tcp://localhost:4840",
        interval: int = 10 * MILLISECOND,
        user: str = "",
        patience: int = 10 * SECOND,
        timeout: int = 0,
        **nodes: str,
    ) -> None:
        super().__init__(f"opcua {url}", outputs, patience=patience, timeout=timeout)
        self._url, self._interval, self._user = url, interval, user
        self._outputs = addressed(outputs, "node", nodes)
        self._inputs = addressed(inputs, "node", nodes)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._client: Any = None
        self._ports: dict[Any, str] = {}
        """Of the variables that are read, by node."""
        self._begun: set[Any] = set()
        self._targets: dict[str, tuple[Any, Any]] = {}
        """The variables that are written, with their types."""
        self._unwritten: dict[str, Any] = {}
        """Values that are still to be written."""
        self._writing = asyncio.Lock()
        self._ua: Any = None
        self._ending = False

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        asyncua = library("asyncua", "asyncua", "opcua")
        self._ua = asyncua.ua
        logging.getLogger("asyncua").addHandler(logging.NullHandler())
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=f"{self.name}", daemon=True)
        self._thread.start()
        self._client = asyncua.Client(self._url, timeout=_PATIENCE)
        if self._user:
            self._client.set_user(self._user)
            self._client.set_password(os.environ.get("OPCUA_PASSWORD", ""))
        self._await(self._begin())

    def _await(self, work: Coroutine[Any, Any, None]) -> None:
        assert self._loop is not None
        asyncio.run_coroutine_threadsafe(work, self._loop).result(4 * _PATIENCE)

    async def _begin(self) -> None:
        try:
            await self._client.connect()
        except (OSError, TimeoutError) as error:
            raise DeviceError(
                f"there is no server: {str(error) or 'it does not answer'}; start it, or correct `url`"
            ) from None
        except self._ua.UaError as error:
            raise DeviceError(f"the server refuses: {_text(error)}; see `user` and OPCUA_PASSWORD") from None
        self._client.connection_lost_callback = self._lost
        for port, name in self._inputs.items():
            node = await self._node(port, name)
            self._targets[port] = node, await node.read_data_type_as_variant_type()
        nodes = [await self._node(port, name) for port, name in self._outputs.items()]
        self._ports = dict(zip(nodes, self._outputs, strict=True))
        if nodes:
            subscription = await self._client.create_subscription(self._interval / MILLISECOND, self)
            await subscription.subscribe_data_change(nodes)

    async def _node(self, port: str, name: str) -> Any:
        try:
            node = self._client.get_node(name)
            found = await node.read_data_value(raise_on_bad_status=False)
        except (self._ua.UaError, ValueError) as error:
            raise DeviceError(f"{port}_node: the server has no variable {name} ({_text(error)})") from None
        status = found.StatusCode
        if status is not None and status.name in _MISSING:
            raise DeviceError(f"{port}_node: the server has no variable {name} ({status.doc})")
        if port in self._outputs:
            _require_good(name, status)
        return node

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        """Called by asyncua for each change, and once for each variable at the beginning."""
        port = self._ports[node]
        try:
            _require_good(self._outputs[port], data.monitored_item.Value.StatusCode)
        except DeviceError as error:
            self.fail(error)
            return
        if port in self.blocking and node not in self._begun:
            self._begun.add(node)
        else:
            self.receive(port, value)

    async def _lost(self, error: Exception) -> None:
        if not self._ending:
            self.fail(DeviceError("the server has gone away: start it, and the program again"))

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``: it does not wait; a value that is overtaken by another is not written."""
        assert self._loop is not None
        _, type_ = self._targets[port]
        self._unwritten[port] = self._ua.DataValue(self._ua.Variant(self._converted(port, value, type_), type_))
        asyncio.run_coroutine_threadsafe(self._write_all(), self._loop)

    def _converted(self, port: str, value: Any, type_: Any) -> Any:
        kinds = self._ua.VariantType
        if isinstance(value, list):
            return [self._converted(port, part, type_) for part in value]
        if type_ in (kinds.Float, kinds.Double):
            return float(value)
        if type_ == kinds.Boolean:
            return bool(value)
        if isinstance(value, float) and not value.is_integer():
            raise DeviceError(f"{port}: {value!r} cannot be written to a variable of type {type_.name}")
        return int(value)

    async def _write_all(self) -> None:
        async with self._writing:
            while self._unwritten:
                port, value = self._unwritten.popitem()
                try:
                    await self._targets[port][0].write_value(value)
                except (TimeoutError, self._ua.UaError, OSError) as error:
                    self._unwritten.clear()
                    self.fail(DeviceError(f"{self._inputs[port]} cannot be written: {_text(error)}"))

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``: after the last values have been written."""
        if self._loop is None or self._thread is None:
            return
        self._ending = True
        try:
            if self._client is not None:
                self._await(self._end())
        finally:
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(1)
            self._loop.close()

    async def _end(self) -> None:
        await self._write_all()
        with suppress(TimeoutError, self._ua.UaError, OSError):  # The server may be gone.
            await self._client.disconnect()


def _require_good(name: str, status: Any) -> None:
    """Raises DeviceError for a value that its server calls bad: it may not be there at all."""
    if status is not None and status.is_bad():
        raise DeviceError(f"{name} has no value: its status is {status.name} ({status.doc})")


def _text(error: Exception) -> str:
    return str(error).partition("(")[0].strip() or type(error).__name__
