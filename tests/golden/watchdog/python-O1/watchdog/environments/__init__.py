"""The environments of Oven, by their names in the text."""

from __future__ import annotations

from .kitchen import Kitchen

ENVIRONMENTS: dict[str, type] = {
    "Kitchen": Kitchen,
}
