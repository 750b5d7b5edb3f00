"""The process Ring."""

from __future__ import annotations

from .cell import Cell
from .runtime import Channel, Process, parallel
from .starter import Starter


class Ring(Process):
    """A token circulates through `cells` cells.

    Source: ring.csp:35
    """

    def __init__(self, name: str) -> None:
        super().__init__(name, source="ring.csp:35")
        self.starter_output = Channel[int](f"{name}.starter.output")
        self.cell_output = [Channel[int](f"{name}.cell[{i}].output") for i in range(9)]
        self.back = Channel[int](f"{name}.back")
        self.starter = Starter(f"{name}.starter", input_=self.back, output=self.starter_output)
        self.cell = [
            Cell(f"{name}.cell[0]", input_=self.starter_output, output=self.cell_output[0]),
            *(
                Cell(
                    f"{name}.cell[{i}]", input_=self.cell_output[i - 1], output=self.cell_output[i]
                )
                for i in range(1, 9)
            ),
            Cell(f"{name}.cell[9]", input_=self.cell_output[8], output=self.back),
        ]

    async def run(self) -> None:
        await parallel(self.starter, parallel(*self.cell))
