"""Runs Spindle in one of its environments."""

from __future__ import annotations

import sys

from .runtime.command_line import Program
from .runtime.command_line import main as run


def main() -> int:
    """Run as the command line says; the exit code."""
    return run("emergency", _load)


def _load() -> Program:
    """Import the program: a signal that comes meanwhile ends it in words."""
    from .environments import ENVIRONMENTS
    from .network import PORTS, build

    return Program(build, ENVIRONMENTS, PORTS)


if __name__ == "__main__":
    sys.exit(main())
