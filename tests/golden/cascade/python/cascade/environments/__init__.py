"""The environments of Cascade, by their names in the text."""

from __future__ import annotations

from .bench import Bench

ENVIRONMENTS: dict[str, type] = {
    "Bench": Bench,
}
