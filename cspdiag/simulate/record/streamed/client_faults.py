"""What the library of the socket reports of its clients: said once a kind, however many clients do it."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable
from typing import Final

_LIBRARY: Final = "foxglove"
_ADDRESS: Final = re.compile(r"(?:\d+(?:\.\d+){3}|\[[0-9a-fA-F:%.\w]*\]):\d+")
_MEANINGS: Final = (
    ("handshake failed", "a client was refused, as it does not ask for the protocol `foxglove.sdk.v1`"),
    ("Error receiving", "a client has gone away without a farewell"),
    ("Error sending", "a client has gone away without a farewell"),
    ("Invalid message", "a message of a client is not understood"),
)


class ClientFaults(logging.Handler):
    """Says a fault of clients when it comes for the first time; ``say`` is called in threads of the library."""

    def __init__(self, say: Callable[[str], object]) -> None:
        super().__init__(logging.WARNING)
        self._say = say
        self._said: set[str] = set()
        self._logger = logging.getLogger(_LIBRARY)

    def begin(self) -> None:
        """From now on the library reports nothing by itself."""
        self._logger.addHandler(self)
        self._logger.propagate = False

    def finish(self) -> None:
        """The library reports by itself again."""
        self._logger.removeHandler(self)
        self._logger.propagate = True

    def emit(self, record: logging.LogRecord) -> None:
        """See ``logging.Handler``."""
        message = record.getMessage()
        meaning = next((meaning for part, meaning in _MEANINGS if part in message), None)
        if meaning is None:
            meaning = _ADDRESS.sub("a client", message)
        kind = meaning.partition(":")[0]
        if kind not in self._said:
            self._said.add(kind)
            self._say(f"{meaning} (said once)")
