"""The process Commstime."""

from __future__ import annotations

from contextlib import suppress

from .consumer import Consumer
from .delta import Delta
from .exceptions import Finished
from .prefix import Prefix
from .runtime import Channel, Process, parallel
from .successor import Successor


class Commstime(Process):
    """The natural numbers, made by four processes in a circle.

    Source: commstime.csp:60

    Parameters:
        rounds: int.
    """

    def __init__(self, name: str, *, rounds: int) -> None:
        super().__init__(name, source="commstime.csp:60")
        self.a = Channel[int](f"{name}.a")
        self.b = Channel[int](f"{name}.b")
        self.c = Channel[int](f"{name}.c")
        self.d = Channel[int](f"{name}.d")
        self.prefix = Prefix(f"{name}.prefix", first=0, input_=self.d, output=self.a)
        self.delta = Delta(f"{name}.delta", input_=self.a, first=self.b, second=self.c)
        self.successor = Successor(f"{name}.successor", input_=self.c, output=self.d)
        self.consumer = Consumer(f"{name}.consumer", rounds=rounds, input_=self.b)

    async def run(self) -> None:
        with suppress(Finished):
            await parallel(self.prefix, self.delta, self.successor, self.consumer)
