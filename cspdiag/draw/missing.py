"""The exception for drawing tools that are not installed."""

from __future__ import annotations

from cspdiag.base.errors import CspdiagError


class MissingToolError(CspdiagError):
    """Something that drawing needs is not installed; the message is one line that says how to install it."""


def missing(what: str) -> MissingToolError:
    """The error for a package, or for a file that wheels contain and a checkout has to fetch."""
    if what.startswith("the "):
        return MissingToolError(f"{what} is not there: in a checkout `make setup` fetches it with npm")
    return MissingToolError(f"drawing needs {what}: pip install 'cspdiag[draw]'")
