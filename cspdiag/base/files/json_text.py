"""JSON in files, which may be damaged in any way."""

from __future__ import annotations

import json
from typing import Any


def read_json(text: str) -> Any:
    """The value of a text. Raises ValueError for one that is not JSON, or is nested deeper than Python can follow."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
