"""Says what has to be installed before something can be drawn."""

from __future__ import annotations

from cspdiag.base.errors import CspdiagError


class MissingToolError(CspdiagError):
    """Something that drawing needs is not installed; the text is one line that says what helps."""


def missing(what: str) -> MissingToolError:
    """The error for a package, or for what the wheel brings and a checkout has to fetch."""
    if what.startswith("the "):
        return MissingToolError(f"{what} is not there: in a checkout `make setup` fetches it with npm")
    return MissingToolError(f"drawing needs {what}: pip install 'cspdiag[draw]'")
