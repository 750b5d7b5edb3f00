"""cspdiag without packages that it needs on a machine, as in a browser."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch


@contextmanager
def without_numpy() -> Iterator[None]:
    """numpy, and what needs it, cannot be imported inside."""
    with patch.dict(sys.modules, {"numpy": None, "control": None, "scipy": None}):
        yield
