"""A child that a driver or a body forks during a run, and that comes back into it: devices and processes are its
parent's.
"""

from __future__ import annotations

import os
from typing import Any, NoReturn


class _End:
    """Stands in for whatever such a child comes upon: it ends there, without a word and without flushing what its
    parent has yet to write.
    """

    received: Any = None
    process: Any = None

    def read(self) -> NoReturn:
        """As a line of an input."""
        os._exit(1)

    def write(self, value: object) -> NoReturn:
        """As a line of an output."""
        os._exit(1)

    def resume(self, _: None) -> NoReturn:
        """As a party."""
        os._exit(1)


end_of_child: Any = _End()
