"""What every part of the interpreter needs, and the signals with which they pass a thread to each other."""

from __future__ import annotations

from tests.oracle.machine.channels import Channels
from tests.oracle.machine.clock import Clock
from tests.oracle.machine.link import Linked
from tests.oracle.machine.policy import Policy
from tests.oracle.machine.state import Signal, State, Thread

NEXT: Signal = ("next",)
CANCEL: Signal = ("cancel",)


class MustWaitError(Exception):
    """The thread that runs has to wait."""


class Core:
    def __init__(self, linked: Linked, policy: Policy) -> None:
        self.linked = linked
        self.policy = policy
        self.channels = Channels(linked, policy, self.fire)
        self.clock = Clock(linked, policy, self.channels)
        self.written = self.clock.written
        self.visible = self.clock.made

    def fire(self, st: State, thread: Thread, depth: int) -> None:
        """The guard of an interrupt has become ready."""
        raise NotImplementedError
