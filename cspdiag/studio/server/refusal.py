"""What a page is answered whose request cannot be met."""

from __future__ import annotations

from typing import Any

from cspdiag.base.errors import CspdiagError


class RefusedError(CspdiagError):
    """A request cannot be met; the text says why, and ``help`` what to do."""

    def __init__(self, text: str, help: str | None = None) -> None:
        super().__init__(text)
        self.help = help

    def as_data(self) -> dict[str, Any]:
        """The error of a message."""
        return {"message": str(self), **({"help": self.help} if self.help is not None else {})}
