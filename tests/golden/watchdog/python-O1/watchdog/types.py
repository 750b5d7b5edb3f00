"""Enums and structs of the program."""

from __future__ import annotations

from typing import NamedTuple


class Reading(NamedTuple):
    """The struct Reading."""

    number: int
    temperature: float
