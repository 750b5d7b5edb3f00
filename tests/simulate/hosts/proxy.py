"""A proxy between places, which delays what passes, and can cut the connections or fall silent."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import suppress


class Proxy:
    """Accepts connections at ``port`` and passes them on to ``target``, each piece after ``delay`` seconds."""

    def __init__(self, target: int, delay: float) -> None:
        self._target = target
        self._delay = delay
        self._listener = socket.create_server(("127.0.0.1", 0))
        _hold_little(self._listener)
        self.port = int(self._listener.getsockname()[1])
        self._open: list[socket.socket] = []
        self._is_cut = False
        self._passes = threading.Event()
        self._passes.set()
        self._thread = threading.Thread(target=self._accept, daemon=True)
        self._thread.start()

    def cut(self) -> None:
        """Ends all connections; new ones are refused."""
        self._is_cut = True
        for connection in self._open:
            with suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)
        self._open.clear()

    def fall_silent(self) -> None:
        """Passes nothing any more, as a cable that was pulled: connections stay, and neither end notices."""
        self._passes.clear()

    def reopen(self) -> None:
        """Accepts connections again."""
        self._is_cut = False

    def close(self) -> None:
        """Ends."""
        self.cut()
        self._passes.set()
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._thread.join()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            if self._is_cut:
                client.close()
                continue
            try:
                server = socket.socket()
                _hold_little(server)
                server.connect(("127.0.0.1", self._target))
            except OSError:
                client.close()
                continue
            self._open += [client, server]
            for end in (client, server):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            for source, sink in ((client, server), (server, client)):
                threading.Thread(target=self._pass, args=(source, sink), daemon=True).start()

    def _pass(self, source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(65536):
                time.sleep(self._delay)
                self._passes.wait()
                sink.sendall(data)
        for end in (source, sink):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)


def _hold_little(connection: socket.socket) -> None:
    """Lets the system hold so little that nothing more is acknowledged soon after the proxy has fallen silent."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
