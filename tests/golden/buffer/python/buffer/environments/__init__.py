"""The environments of Line, by their names in the text."""

from __future__ import annotations

from .shelf import Shelf

ENVIRONMENTS: dict[str, type] = {
    "Shelf": Shelf,
}
