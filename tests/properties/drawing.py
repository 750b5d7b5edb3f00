"""Draws random programs, the same ones for the same start."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import HealthCheck, Phase, given, seed, settings

from tests.properties.encounters import encounters
from tests.properties.programs import programs


def draw_programs(look: Callable[[str], None], count: int, start: int | None = None, *, shrink: bool = True) -> None:
    """Pass ``count`` programs to ``look``. An exception of it ends the search, with ``shrink`` at the smallest program
    that raises one, which may take minutes.

    Programs of one start resemble each other: several starts with few programs each show more than one with many.
    Without ``start``, they are different ones each time.
    """

    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        derandomize=False,
        phases=(Phase.generate, Phase.shrink) if shrink else (Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(encounters() | programs())
    def search(text: str) -> None:
        look(text)

    (search if start is None else seed(start)(search))()
