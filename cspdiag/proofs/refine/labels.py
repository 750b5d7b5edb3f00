"""Labels: what a specification sees of an event, its port, and its value if both sides distinguish values."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.transitions.systems.system import Event, System, with_value

Label: TypeAlias = tuple[str, str | None]
"""The name of the port within the outermost process, and the value; None is any value."""

END: Label = ("", None)
"""The end of all processes."""


@record
class Labels:
    """The labels of events of a process, as far as its specification distinguishes them; events of ``hidden`` ports
    have none.
    """

    specification: System
    hidden: Collection[str] = ()

    @cached_property
    def distinguished(self) -> frozenset[str]:
        """The ports of which the specification distinguishes values."""
        return frozenset(
            port(event)
            for event in self.specification.events
            if event.visible and event.value is not None and not self.hides(port(event))
        )

    def of(self, event: Event) -> Label | None:
        """The label, or None if the specification does not see the event."""
        if not event.visible or self.hides(port(event)):
            return None
        return port(event), event.value if port(event) in self.distinguished else None

    def of_value(self, name: str, value: str) -> Label:
        """The label of a communication at a port that is not hidden, with a value as transition systems write it."""
        return name, value if name in self.distinguished else None

    def hides(self, name: str) -> bool:
        """Whether the specification does not see a port."""
        return name in self.hidden or name.partition("[")[0] in self.hidden


def port(event: Event) -> str:
    """The port of a visible event: the path of its channel without the outermost process."""
    return event.channel.partition(".")[2] or event.channel


def covers(one: Label, other: Label) -> bool:
    """Whether an event of a specification with the first label may be one with the second."""
    return one[0] == other[0] and one[1] in (None, other[1])


def is_open(label: Label) -> bool:
    """Whether a label has no single known value but a range of numbers, or a value that is only passed on."""
    return label[1] is not None and (".." in label[1] or label[1].startswith("("))


def words(label: Label) -> str:
    """The label in words."""
    if label == END:
        return "the end"
    return f"`{with_value(*label)}`"
