"""Why a request has no result."""

from __future__ import annotations

from cspdiag.base.errors import CspdiagError


class RequestError(CspdiagError):
    """The request cannot be carried out, as the message says to the user; ``help`` says what to do."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help
