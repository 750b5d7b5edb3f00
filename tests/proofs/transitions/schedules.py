"""Runs of the reference in which everything that the language leaves open is drawn: which process continues, which
guard is chosen, and what the environment offers.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from cspdiag.model.sampling import Sampling
from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, Type
from cspdiag.network.ir.network import Network
from cspdiag.semantics.execute import execute
from cspdiag.semantics.requests import Task
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.semantics.trace import Execution

STEP = 1_000_000
"""Nanoseconds between the instants at which the environment may offer something."""
_NONE = "none of those that the text has"
NUMBERS = (-1, 0, 1, 2, 3, 7)


class Whim:
    """An environment that may offer anything, until it stops offering."""

    grid = Sampling(STEP)

    def __init__(self, network: Network, random: Random) -> None:
        self._random = random
        inputs = [port for port in network.external_ports if port.direction == "in"]
        self._types = {port.name: port.type for port in inputs}
        self._present = {name: drawn(type_, random) for name, type_ in self._types.items()}
        self._ends = {name: random.choice((0, 5, 20, 1000)) * STEP for name in self._types}
        self._now = 0

    def advance(self, now: int) -> None:
        """Advance to ``now``."""
        self._now = now
        for name, type_ in self._types.items():
            if now < self._ends[name] and self._random.random() < 0.4:
                self._present[name] = drawn(type_, self._random)

    def output(self, port: str) -> Any:
        """The present value for an input of the program."""
        return self._present[port]

    def give(self, port: str, value: Any) -> None:
        """Accept any value."""


def drawn(type_: Type, random: Random) -> Any:
    """A value of a type."""
    match type_:
        case BoolType():
            return random.random() < 0.5
        case EnumType():
            return random.randrange(len(type_.literals))
        case RealType():
            return float(random.choice(NUMBERS))
        case IntType():
            return random.choice(NUMBERS if type_.signed else NUMBERS[1:])
        case ArrayType():
            return tuple(drawn(type_.element, random) for _ in range(type_.size or 0))
        case StructType():
            return tuple(drawn(field, random) for _, field in type_.fields)
    return random.choice(NUMBERS[1:]) * STEP


def random_run(network: Network, seed: int, until: int) -> Execution:
    """One of the runs of a network, up to ``until`` nanoseconds: which process of a level continues, and which guard of
    ``[]`` is chosen, is drawn too.
    """
    random = Random(seed)
    timeouts = not network.environments or any(entry.on_miss == "timeout" for entry in network.environments)

    class AnyOrder(Scheduler):
        def next_task(self, ready: Sequence[Task]) -> Task:
            return random.choice(ready)

        def fair(self, ready: Sequence[int], last: int) -> int:
            return random.choice(ready)

    def scheduler(top: str, *_: object, **__: object) -> Scheduler:
        return AnyOrder(top, Whim(network, random), timeouts)

    return execute(network, _NONE, until, scheduler=scheduler)
