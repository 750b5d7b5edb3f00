"""The environments of Jiwy, by their names in the text."""

from __future__ import annotations

from .bench import Bench
from .gamepad import Gamepad
from .worn import Worn

ENVIRONMENTS: dict[str, type] = {
    "Bench": Bench,
    "Worn": Worn,
    "Gamepad": Gamepad,
}
