"""The environments of SymmetricTable, by their names in the text."""

from __future__ import annotations

ENVIRONMENTS: dict[str, type] = {}
