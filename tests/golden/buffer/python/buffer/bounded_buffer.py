"""The process BoundedBuffer."""

from __future__ import annotations

from .constants import capacity, items, producers
from .runtime import (
    Alternative,
    In,
    Input,
    Out,
    Output,
    Process,
    Variable,
    element,
    int64,
    remainder,
    replaced,
)


class BoundedBuffer(Process):
    """Takes items while there is room and gives them away, oldest first, while there are any.

    Source: buffer.csp:24

    Ports:
        input: in, int.
        output: out, int.
    """

    def __init__(self, name: str, *, input_: In[int], output: Out[int]) -> None:
        super().__init__(name, source="buffer.csp:24")
        self.output = output
        self.input_ = input_.reader(self)
        self.ring = Variable[tuple[int, ...]](f"{name}.ring", (0, 0, 0, 0))
        self.oldest = Variable[int](f"{name}.oldest", 0)
        self.count = Variable[int](f"{name}.count", 0)
        self.given = Variable[int](f"{name}.given", 0)
        self.choice = Alternative(Input(self.input_), Output(self.output))

    async def run(self) -> None:
        while True:
            # buffer.csp:39
            value_1 = element(self.ring.value, self.oldest.value) if self.count.value > 0 else None
            # buffer.csp:37
            match await self.choice.select(
                enabled=(self.count.value < capacity, self.count.value > 0), values={1: value_1}
            ):
                case 0:  # input ? ring[(oldest + count) % capacity]
                    # buffer.csp:37
                    self.ring.value = replaced(
                        self.ring.value,
                        self.choice.value,
                        remainder(int64(self.oldest.value + self.count.value), capacity),
                    )
                    self.count.value = int64(self.count.value + 1)  # buffer.csp:37
                case 1:  # output ! ring[oldest]
                    # buffer.csp:40
                    self.oldest.value = remainder(int64(self.oldest.value + 1), capacity)
                    self.count.value = int64(self.count.value - 1)  # buffer.csp:41
                    self.given.value = int64(self.given.value + 1)  # buffer.csp:42
            if self.given.value == producers * items:
                break
