"""Changes of the parameters of a program from another thread, while it runs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Protocol

from cspdiag.arguments import Setting, settings_of
from cspdiag.settings import SettingError
from cspdiag.tuning import parse_change

if TYPE_CHECKING:
    from cspdiag.model.program import Program
    from cspdiag.runtime.kernel.parameters import Change


class ChangedParameters(Protocol):
    """The parameters of a running program."""

    def plan(self, changes: Iterable[Change]) -> None:
        """Make these changes, each at its time, from any thread."""
        ...


class RunningProgram(Protocol):
    """A program that runs, in another thread."""

    @property
    def parameters(self) -> ChangedParameters:
        """Its parameters."""
        ...

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        ...


class Tuning:
    """Changes the parameters of a program while it runs, from other threads: ``program.run(real_time=True,
    tune=tuning)`` in one, and ``tuning.set("gains.kp", 3)`` in another. Each takes effect at the next instant.
    """

    def __init__(self) -> None:
        self._program: Program | None = None
        self._running: RunningProgram | None = None

    def attach(self, program: Program, running: RunningProgram) -> None:
        """The run begins."""
        self._program, self._running = program, running

    def set(self, name: str, value: Setting) -> None:
        """Change a parameter, or a field or an element of one, to a value as the language writes it, or to a number.

        Raises SettingError for a name that is no parameter, a value that does not fit, and before the run has begun.
        """
        if self._program is None or self._running is None:
            raise SettingError("nothing runs yet: pass this object to `run(tune=…)` in another thread first")
        (text,) = settings_of({name: value}).values()
        self._running.parameters.plan([parse_change(self._program, self._running.now, name, text)])
