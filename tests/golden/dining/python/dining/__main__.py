"""Runs Table in one of its environments."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .runtime.command_line import Program


def main() -> int:
    """Run as the command line says, and return the exit code."""
    try:
        from .runtime.command_line import main as run

        return run("dining", _load)
    except KeyboardInterrupt:
        # Ctrl-C was pressed while the runtime was being imported; a run handles it itself.
        return 130


def _load() -> Program:
    """Import the program; a signal that arrives meanwhile is handled by the runtime."""
    from .environments import ENVIRONMENTS
    from .network import PORTS, build
    from .runtime.command_line import Program

    return Program(build, ENVIRONMENTS, PORTS)


if __name__ == "__main__":
    sys.exit(main())
