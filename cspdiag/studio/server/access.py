"""Who may talk to the server: who has the link, and no page of another origin.

A page that a browser has loaded from elsewhere can send requests to loopback, and a name that its owner points to
127.0.0.1 makes them look local (DNS rebinding). So the host that a request names and the origin of the page that sends
it are compared with those of the server, and the token of the link is required for everything that reaches a program.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping

from cspdiag.base.record import record

_LOOPBACK = ("127.0.0.1", "localhost", "[::1]")


@record
class Access:
    """What is required of requests."""

    port: int
    token: str

    @property
    def hosts(self) -> frozenset[str]:
        """The hosts by which requests may name the server."""
        return frozenset(f"{host}:{self.port}" for host in _LOOPBACK)

    def knows_host(self, headers: Mapping[str, str]) -> bool:
        """Whether a request names this server."""
        return headers.get("host", "").lower() in self.hosts

    def knows_origin(self, headers: Mapping[str, str]) -> bool:
        """Whether a request comes from the page of this server, or from no page at all."""
        origin = headers.get("origin")
        return origin is None or (origin.lower().removeprefix("http://") in self.hosts and origin.startswith("http://"))

    def knows_token(self, token: str) -> bool:
        """Whether it is that of the link."""
        return secrets.compare_digest(token.encode(), self.token.encode())


class SingleUse:
    """A code that is exchanged for the link once. The command line of a browser, which other users of the machine can
    see, has it instead of the token.
    """

    def __init__(self) -> None:
        self.code = new_token()
        self._unused = True

    def use(self, code: str) -> bool:
        """Whether the code is right, and was not used before."""
        right = secrets.compare_digest(code.encode(), self.code.encode())
        usable = right and self._unused
        if right:
            self._unused = False
        return usable


def new_token() -> str:
    """A token that cannot be guessed: 256 bits."""
    return secrets.token_urlsafe(32)
