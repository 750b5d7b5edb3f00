"""The memory that a generated network takes while it waits: ``resident.py FOLDER PROCESSES``."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

from timing import leave, report, resident


class Observer:
    """An environment that only reads the memory."""

    step = 1_000_000
    drivers: dict[str, Any] = {}  # noqa: RUF012 - what every environment has

    def __init__(self, before: int, processes: int) -> None:
        self.before, self.processes = before, processes

    def start(self) -> None:
        pass

    def advance(self, now: int) -> None:
        report((resident() - self.before) / self.processes)
        leave()


folder = Path(sys.argv[1])
package = next(path.parent for path in folder.rglob("network.py") if path.parent.name != "runtime")
sys.path.insert(0, str(package.parent))
network = importlib.import_module(f"{package.name}.network")
before = resident()
network.build({}).run(Observer(before, int(sys.argv[2])))
