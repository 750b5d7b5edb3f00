"""Runs Oven in one of its environments."""

from __future__ import annotations

import sys

from .environments import ENVIRONMENTS
from .network import PORTS, build
from .runtime.command_line import main as run


def main() -> int:
    """Run as the command line says; the exit code."""
    return run("watchdog", build, ENVIRONMENTS, PORTS)


if __name__ == "__main__":
    sys.exit(main())
