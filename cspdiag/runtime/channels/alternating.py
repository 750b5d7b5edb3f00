"""What channels know of the alternatives that wait at them."""

from __future__ import annotations

from typing import Any, Protocol

from ..kernel.party import Party
from ..kernel.scheduler import Task


class Alternating(Protocol):
    """An alternative or an interrupt that waits with guards, which are numbered in text order."""

    task: Task
    began: int
    """The alternatives that wait are numbered in the order in which they began to."""

    def value_offered(self, index: int) -> Any:
        """The value of an output guard, for the other side."""
        ...

    def only_promises(self, index: int) -> bool:
        """Whether choosing the guard leaves the communication to the guarded process."""
        ...

    def resolve(self, index: int, value: Any) -> None:
        """The other side has chosen guard ``index`` and has communicated."""
        ...

    def pledge(self, index: int) -> Party:
        """The other side has chosen output guard ``index`` and will read later; the party waits for that."""
        ...
