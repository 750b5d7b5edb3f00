"""The environments of Spindle, by their names in the text."""

from __future__ import annotations

from .workshop import Workshop

ENVIRONMENTS: dict[str, type] = {
    "Workshop": Workshop,
}
