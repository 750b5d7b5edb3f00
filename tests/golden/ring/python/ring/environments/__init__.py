"""The environments of Ring, by their names in the text."""

from __future__ import annotations

ENVIRONMENTS: dict[str, type] = {}
