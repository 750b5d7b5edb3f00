"""A child that a driver or a body forks during a run, and that returns into the run: devices and processes belong to
its parent.
"""

from __future__ import annotations

import os
from typing import Any, NoReturn


class _End:
    """Replaces whatever such a child would use next: the child ends there, silently and without flushing what its
    parent has yet to write.
    """

    received: Any = None
    process: Any = None

    def read(self) -> NoReturn:
        """See ``DirectLine.read``."""
        os._exit(1)

    def write(self, value: object) -> NoReturn:
        """See ``DirectLine.write``."""
        os._exit(1)

    def resume(self, _: None) -> NoReturn:
        """See ``Party.resume``."""
        os._exit(1)

    def __next__(self) -> NoReturn:
        os._exit(1)


end_of_child: Any = _End()
