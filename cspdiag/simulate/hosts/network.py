"""Bytes between places over Zenoh: the first place listens at the address, the others connect to it.

What two of the others send to each other goes through the first place, and also directly, where they can reach each
other: so it arrives although the first place is gone, or although a firewall lets in the port of the first place only.
Frames that arrive twice do no harm.
"""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from queue import SimpleQueue
from typing import Any

from cspdiag.runtime.kernel.signals import left_to_the_main_thread
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.simulate.hosts.links import PlaceError

_PATIENCE = 1.0
"""Seconds that what was sent last has to reach the other places."""
_RETRY = {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}
"""When to try again to connect, if the first place does not listen yet."""
_LOOPBACK = ("localhost", "127.0.0.1", "::1")
"""Names of this machine itself: an operating system may take the first for either of the others."""
_DIRECTLY = "directly"
_LOOK = 0.05
"""Seconds after which a place that connects looks whether it has to stop."""
_threads: list[threading.Thread] = []
"""All that make or close connections, or did."""


class ZenohTransport:
    """See ``Transport``. ``address`` is ``HOST:PORT``; ``room`` is what the keys of one program begin with."""

    def __init__(self, address: str, room: str, *, listens: bool, patience: float) -> None:
        self._address = address
        self._room = room
        self._listens = listens
        self._patience = patience
        self._session: Any = None
        self._direct: Any = None
        """The session of a place that is not the first with the others that are not, if there is one."""
        self._publishers: dict[str, tuple[Any, ...]] = {}

    def open(self, place: str, arrived: Callable[[bytes], None]) -> None:
        """See ``Transport.open``."""
        self._session = self._listening() if self._listens else self._connected()
        self._session.declare_subscriber(f"{self._room}/{place}", lambda sample: arrived(sample.payload.to_bytes()))
        if not self._listens:
            self._direct = self._directly_connected()
        if self._direct is not None:
            key = f"{self._room}/{_DIRECTLY}/{place}"
            self._direct.declare_subscriber(key, lambda sample: arrived(sample.payload.to_bytes()))

    def _listening(self) -> Any:
        zenoh = _library()
        endpoint = {"listen/endpoints": [_endpoint(self._address)], "listen/exit_on_failure": True}
        try:
            return zenoh.open(_config(zenoh, mode="router", **endpoint))
        except zenoh.ZError as error:
            raise PlaceError(
                f"the first place listens at its address, but {self._address} is not free or not of this machine "
                f"({_first_line(error)})"
            ) from None

    def _connected(self) -> Any:
        zenoh = _library()
        until = time.monotonic() + self._patience
        self._address = _listened_at(self._address, until)
        config = _config(
            zenoh,
            mode="client",
            **{
                "connect/endpoints": [_endpoint(self._address)],
                "connect/exit_on_failure": True,
                # One try takes several round trips, so none is ended before the others are.
                "connect/timeout_ms": max(1, round((until - time.monotonic()) * 1000)),
                "connect/retry": _RETRY,
            },
        )
        answers: SimpleQueue[Any] = SimpleQueue()
        connecting = _started("connecting", _open, zenoh, self._address, config, answers)
        while connecting.is_alive():
            connecting.join(_LOOK)
            stopping.check()
        answer = answers.get()
        if isinstance(answer, OSError):
            raise PlaceError(f"the host of {self._address} is unknown here ({answer.strerror})")
        if not isinstance(answer, zenoh.ZError):
            return answer
        if _accepts(self._address):
            raise PlaceError(
                f"what listens at {self._address} does not answer as the first place of a program does"
                f" ({_first_line(answer)})"
            )
        raise PlaceError(f"nobody listens at {self._address}: start the first place there ({_first_line(answer)})")

    def _directly_connected(self) -> Any:
        """A session whose partners learn of each other from the first place."""
        zenoh = _library()
        endpoints = {
            "listen/endpoints": [_endpoint(f"{_own_address(self._address)}:0")],
            "connect/endpoints": [_endpoint(self._address)],
            "connect/exit_on_failure": False,
            "connect/timeout_ms": 0,
        }
        try:
            return zenoh.open(_config(zenoh, mode="peer", **endpoints))
        except zenoh.ZError:
            return None

    def send(self, place: str, data: bytes) -> None:
        """See ``Transport.send``."""
        zenoh = _library()
        publishers = self._publishers.get(place)
        if publishers is None:
            ways = [(self._session, place), (self._direct, f"{_DIRECTLY}/{place}")]
            publishers = self._publishers[place] = tuple(
                session.declare_publisher(
                    f"{self._room}/{key}", express=True, congestion_control=zenoh.CongestionControl.DROP
                )
                for session, key in ways
                if session is not None
            )
        for publisher in publishers:
            with suppress(zenoh.ZError):  # It is sent again.
                publisher.put(data)

    def close(self) -> None:
        """See ``Transport.close``."""
        # Over a link that is gone it waits for ten seconds, and then fails.
        sessions = [session for session in (self._session, self._direct) if session is not None]
        until = time.monotonic() + _PATIENCE
        closing = [_started("link", _close, session) for session in sessions]
        for thread in closing:
            thread.join(max(0.0, until - time.monotonic()))


def has_threads() -> bool:
    """Whether connections of this process are still being made or closed, in threads that cannot be ended."""
    return any(thread.is_alive() for thread in _threads)


def _started(name: str, does: Callable[..., None], *arguments: Any) -> threading.Thread:
    """A thread that does something which may take longer than anybody waits for it."""
    thread = threading.Thread(target=does, args=arguments, name=name, daemon=True)
    _threads.append(thread)
    with left_to_the_main_thread():
        thread.start()
    return thread


def _close(session: Any) -> None:
    with suppress(_library().ZError):
        session.close()


def _open(zenoh: Any, address: str, config: Any, answers: SimpleQueue[Any]) -> None:
    """Answers with a session, or with why there is none."""
    try:
        _found(address)  # Of a name that nobody knows Zenoh says after all its tries that they took too long.
        answers.put(zenoh.open(config))
    except (OSError, zenoh.ZError) as error:
        answers.put(error)


def _found(address: str) -> list[tuple[Any, ...]]:
    """The ways to an address by datagrams, as ``socket.getaddrinfo`` has them. Raises OSError."""
    return socket.getaddrinfo(*_parts(address), type=socket.SOCK_DGRAM)


def _parts(address: str) -> tuple[str, int]:
    """The host, without brackets, and the port of an address."""
    host, _, port = address.rpartition(":")
    return host.strip("[]"), int(port)


def _endpoint(address: str) -> str:
    """An address as Zenoh writes it, which knows network interfaces by number only. Raises PlaceError."""
    host, port = _parts(address)
    host, _, interface = host.partition("%")
    if interface and not interface.isdecimal():
        try:
            interface = str(socket.if_nametoindex(interface))
        except OSError:
            raise PlaceError(f"this machine has no network interface `{interface}`, which {address} names") from None
    zone = f"%{interface}" if interface else ""
    return f"tcp/[{host}{zone}]:{port}" if ":" in host else f"tcp/{host}:{port}"


def _listened_at(address: str, until: float) -> str:
    """The address of the first place, as soon as it listens; the given one after the instant ``until`` of the clock of
    the machine, in seconds. On this machine, its command may have another name of the machine than this one.
    """
    host, port = _parts(address)
    if host not in _LOOPBACK:
        return address
    names = (host, *(name for name in _LOOPBACK if name != host))
    addresses = [f"[{name}]:{port}" if ":" in name else f"{name}:{port}" for name in names]
    while time.monotonic() < until:
        for found in addresses:
            if _accepts(found):
                return found
        time.sleep(_LOOK)
        stopping.check()
    return address


def _own_address(address: str) -> str:
    """The address of this machine at which those that are near another one reach it, too."""
    with suppress(OSError):
        for family, kind, protocol, _, place in _found(address):
            with socket.socket(family, kind, protocol) as probe:
                probe.connect(place)
                own, _, *more = probe.getsockname()
                zone = f"%{more[1]}" if more and more[1] else ""
                return f"[{own}{zone}]" if ":" in own else str(own)
    return "127.0.0.1"


def _accepts(address: str) -> bool:
    """Whether there is something that accepts connections."""
    try:
        socket.create_connection(_parts(address), _PATIENCE).close()
    except OSError:
        return False
    return True


def _library() -> Any:
    try:
        import zenoh
    except ImportError:
        raise PlaceError("places need eclipse-zenoh: pip install 'cspdiag[zenoh]'") from None
    return zenoh


def _config(zenoh: Any, **settings: Any) -> Any:
    config = zenoh.Config()
    for key, value in {"scouting/multicast/enabled": False, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return config


def _first_line(error: Exception) -> str:
    return str(error).partition(" at /")[0].splitlines()[0].rstrip(".")
