"""The process Fork."""

from __future__ import annotations

from .constants import meals
from .runtime import Alternative, In, Input, Process, Variable, int64


class Fork(Process):
    """Is taken by one of its neighbours and put back by the same one.

    Source: table.csp:7

    Ports:
        left: in, int.
        right: in, int.
    """

    def __init__(self, name: str, *, left: In[int], right: In[int]) -> None:
        super().__init__(name, source="table.csp:7")
        self.left = left.reader(self)
        self.right = right.reader(self)
        self.holder = Variable[int](f"{name}.holder")
        self.uses = Variable[int](f"{name}.uses", 0)
        self.choice = Alternative(Input(self.left), Input(self.right))

    async def run(self) -> None:
        while True:
            match await self.choice.select():  # table.csp:17
                case 0:  # left ? holder
                    self.holder.value = self.choice.value
                    self.holder.value = await self.left.read()  # table.csp:17
                case 1:  # right ? holder
                    self.holder.value = self.choice.value
                    self.holder.value = await self.right.read()  # table.csp:17
            self.uses.value = int64(self.uses.value + 1)  # table.csp:18
            if self.uses.value == 2 * meals:
                break
