"""The process Commstime."""

from __future__ import annotations

from .runtime import Routine, Steps, Task, int64


class Commstime(Routine):
    """The natural numbers, made by four processes in a circle.

    Source: commstime.csp:60
    """

    __slots__ = ()

    kind = "Commstime"
    source = "commstime.csp:60"

    def __init__(self, name: str) -> None:
        super().__init__(name)

    def steps(self, me: Task) -> Steps:
        prefix_value: int = 0
        self.start(me)
        try:
            if prefix_value != 999:
                while True:
                    # commstime.csp:14
                    prefix_value = (
                        n1 if (n1 := prefix_value + 1) <= 9223372036854775807 else int64(n1)
                    )
                    if prefix_value == 999:
                        break
            if False:
                yield
        except BaseException as error:
            self.fail(me, error)
            raise
        self.end(me)
