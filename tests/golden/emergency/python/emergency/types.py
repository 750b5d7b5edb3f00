"""Enums and structs of the program."""

from __future__ import annotations

from enum import IntEnum


class Button(IntEnum):
    """The enum Button."""

    none = 0
    start = 1
    emergency = 2
