"""A program that answers what a device sends: the sampled level plus the last event; 9 ends it, and releases -1."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from queue import Empty, Queue
from typing import Any

import cspdiag
from cspdiag.simulate.result import Run

DECLARED = "out level : double  out go : int  in valve : double"

PROCESS = """
process Main {
  in  level : double @ 10 ms
  in  go    : int
  out valve : double @ 10 ms safe -1

  communication {
    var height  : double = 0
    var command : int    = 0
  }

  composition {
    mu (
      go ? command -> skip
      []>
      level ? height -> valve ! height + double(command)
    ) until command == 9
  }
}
"""


def program(driver: str, arguments: str = "") -> str:
    """The program with ``driver``, the text of the definition of ``Peer``."""
    return f"""{driver}
{PROCESS}
environment Bench for Main on miss count {{
  peer : Peer({arguments})

  peer.level -> level
  peer.go    -> go
  valve      -> peer.valve
}}
"""


class Peer:
    """The other side of a device: ``send`` is the test's, ``heard`` are the values of the valve."""

    def __init__(self, send: Callable[[str, Any], None]) -> None:
        self.send = send
        self.heard: Queue[float] = Queue()
        self.values: list[float] = []

    def expect(self, value: float) -> None:
        """Waits until the valve has this value."""
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            try:
                self.values.append(self.heard.get(timeout=0.5))
            except Empty:
                continue
            if self.values[-1] == value:
                return
        raise AssertionError(f"the valve was {self.values[-5:]}, and not {value}")


def run(text: str, script: Callable[[], None], until: str = "10 s") -> Run:
    """Runs the program in real time while ``script`` acts in a thread; raises what that raises."""
    problems: list[BaseException] = []

    def act() -> None:
        try:
            script()
        except BaseException as problem:
            problems.append(problem)

    thread = threading.Thread(target=act)
    thread.start()
    result = cspdiag.parse(text).run(real_time=True, until=until)
    thread.join(10)
    if problems:
        raise problems[0]
    return result


def failure(result: Run) -> str:
    """How the run failed."""
    assert result.outcome.ended == "failed"
    return str(result.outcome.error)


def converse(peer: Peer) -> Callable[[], None]:
    """The whole conversation: a level, an event twice, a level, the end, and the safe value after it."""

    def script() -> None:
        peer.send("level", 1.5)
        peer.expect(1.5)
        peer.send("go", 2)
        peer.expect(3.5)
        peer.send("level", 4.25)
        peer.expect(6.25)
        peer.send("go", 9)
        peer.expect(-1)

    return script
