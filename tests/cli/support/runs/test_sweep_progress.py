"""The line while a sweep runs."""

from __future__ import annotations

import pytest

from cspdiag.cli.support.runs.sweep_progress import PlanProgress, SweepProgress


@pytest.mark.parametrize(
    ("elapsed", "line"),
    [
        (2.0, "60 of 100 runs, 8 s left"),
        (40.0, "60 of 100 runs, 2 min 40 s left"),
        (4000.0, "60 of 100 runs, 4 h 26 min left"),
    ],
)
def test_what_is_left_is_estimated_from_what_this_process_made(elapsed: float, line: str) -> None:
    progress = SweepProgress(100, 50)
    for _ in range(10):
        progress.done()
    assert progress.line(elapsed) == line


def test_nothing_is_estimated_from_one_run() -> None:
    progress = SweepProgress(100, 50)
    progress.done()
    assert progress.line(1.0) == "51 of 100 runs"


def test_planning_says_how_long_it_takes() -> None:
    assert PlanProgress().line(500, 2000, 2.0) == "comparing equations: 500 of 2000 combinations, 6 s left"
