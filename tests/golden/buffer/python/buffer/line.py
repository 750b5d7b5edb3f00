"""The process Line."""

from __future__ import annotations

from .bounded_buffer import BoundedBuffer
from .consumer import Consumer
from .producer import Producer
from .runtime import AnyChannel, Channel, Out, Process, ms, parallel


class Line(Process):
    """Three producers share one channel into the buffer: first come, first served.

    Source: buffer.csp:64

    Ports:
        done: out, int.
    """

    def __init__(self, name: str, *, done: Out[int]) -> None:
        super().__init__(name, source="buffer.csp:64")
        self.arrivals = AnyChannel[int](f"{name}.arrivals")
        self.departures = Channel[int](f"{name}.departures")
        self.producer = [
            Producer(f"{name}.producer[{i}]", id_=i, period=5 * ms, item=self.arrivals)
            for i in range(3)
        ]
        self.store = BoundedBuffer(f"{name}.store", input_=self.arrivals, output=self.departures)
        self.consumer = Consumer(f"{name}.consumer", item=self.departures, done=done)

    async def run(self) -> None:
        await parallel(parallel(*self.producer), self.store, self.consumer)
