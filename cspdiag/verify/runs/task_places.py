"""Where in the text a task of a run is: of those that wait, and of the one that runs."""

from __future__ import annotations

import sys
from types import CodeType, FrameType

from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.deadlock.tasks import frames_of
from cspdiag.runtime.kernel.places import is_of_runtime, source_line
from cspdiag.runtime.kernel.scheduler import Task

_OUTSIDE = StepwiseRun.run_one.__code__
"""The code that calls this function is not the program's."""


class TaskPlaces:
    """Files and lines, each looked up once."""

    def __init__(self) -> None:
        self._known: dict[tuple[CodeType, int], str | None] = {}

    def of(self, task: Task, current: Task | None) -> str | None:
        """Where a task is; None if unknown. ``current`` is the running task, which has called this."""
        if task is not current:
            frames = list(frames_of(task))
            return self._place(frames[-1]) if frames else None
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and frame.f_code is not _OUTSIDE:
            place = self._place(frame)
            if place is not None:
                return place
            frame = frame.f_back
        return None

    def _place(self, frame: FrameType) -> str | None:
        key = frame.f_code, frame.f_lineno
        if key not in self._known:
            self._known[key] = None if is_of_runtime(frame) else source_line(*key)
        return self._known[key]
