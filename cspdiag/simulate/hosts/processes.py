"""What runs in the outermost process of a place: its own instances, and for the others those who wait for them."""

from __future__ import annotations

from collections.abc import Callable, Generator
from types import coroutine
from typing import Any

from cspdiag.runtime import Process
from cspdiag.runtime.kernel.exceptions import Cancelled, ProcessError
from cspdiag.runtime.kernel.party import Party, Waits
from cspdiag.runtime.kernel.scheduler import Scheduler, Task, present


class Here(Process):
    """An instance of this place; ``ended`` is called with its exception, if it has raised one."""

    def __init__(self, instance: Process, ended: Callable[[str, BaseException | None], None]) -> None:
        super().__init__(instance.name, source=instance.source)
        self.instance = instance
        self._ended = ended

    async def execute(self) -> None:
        """Run the instance."""
        try:
            await self.instance.execute()
        except (Cancelled, GeneratorExit):
            raise
        except BaseException as error:
            self._ended(self.name, error)
            raise
        self._ended(self.name, None)


class Elsewhere(Process):
    """An instance of another place: waits until it has ended there."""

    def __init__(self, instance: Process, place: str) -> None:
        super().__init__(instance.name, source=instance.source)
        self.place = place
        self._task: Task | None = None
        self._is_over = False
        self._error: ProcessError | None = None

    async def run(self) -> None:
        """Wait."""
        await self._wait()

    @coroutine
    def _wait(self) -> Generator[None, None, None]:
        task = present().current
        if task.cancelled:
            raise Cancelled
        if not self._is_over:
            self._task = task
            task.waiting = self
            yield
        if self._error is not None:
            raise self._error

    def end(self, error: ProcessError | None) -> None:
        """It has ended."""
        if self._is_over:
            return
        self._is_over, self._error = True, error
        if self._task is not None:
            self._task.ready_queue.append(self._task.entry)
            self._task = None

    def withdraw(self, party: Party) -> bool:
        """See ``Waitable.withdraw``."""
        waited, self._task = self._task is not None, None
        return waited

    def waits_for(self, party: Party) -> Waits:
        """See ``Waitable.waits_for``."""
        return ((f"in the place {self.place}, whose report says for what", None),)

    def started(self, scheduler: Scheduler) -> None:
        """Observers are not notified: it runs in the other place."""

    def ended(self, scheduler: Scheduler) -> None:
        """Observers are not notified."""


def replace_instances(process: Process, replacement: Callable[[Process], Process]) -> dict[str, Any]:
    """Puts something else into the place of each instance of a process; returns what was put there, by path."""
    replaced: dict[str, Process] = {}

    def replaced_by(part: Any) -> Any:
        if isinstance(part, Process):
            return replaced.setdefault(part.name, replacement(part))
        if isinstance(part, list | tuple) and any(isinstance(item, Process) for item in part):
            return type(part)(replaced_by(item) for item in part)
        return part

    for name, part in list(vars(process).items()):
        if name != "enclosing":
            setattr(process, name, replaced_by(part))
    return replaced
