"""A recording takes as little as it can of a run against the clock."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
driver Noticing python "noticing.py:Noticing" { out level : double }

process Main {
  in level : double @ 10 ms

  communication { var height : double }

  composition { mu (level ? height) }
}

environment Bench for Main on miss count {
  noticing : Noticing
  noticing.level -> level
}
"""

NOTICING = '''
"""A driver that prints which modules are imported from the first sample to the end."""
import sys


class Noticing:
    def __init__(self) -> None:
        self.imported = []

    def find_spec(self, name, path=None, target=None):
        self.imported.append(name)

    def read(self, port):
        if self not in sys.meta_path:
            sys.meta_path.insert(0, self)
        return 1.0

    def close(self):
        sys.meta_path.remove(self)
        print("imported", self.imported)
'''


@pytest.mark.parametrize(
    "options", [["--record", "r.csv"], ["--record", "r.mcap"], ["--serve", "0"]], ids=["csv", "mcap", "serve"]
)
def test_nothing_is_imported_while_the_run_continues(options: list[str], tmp_path: Path) -> None:
    """Importing numpy takes some 50 ms, in which a program at 1 kHz misses 50 samples."""
    if options[0] == "--serve":
        pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")
    (tmp_path / "bench.csp").write_text(PROGRAM)
    (tmp_path / "noticing.py").write_text(NOTICING)
    command = [sys.executable, "-m", "cspdiag", "run", "bench.csp", "--real-time", "--for", "300ms", *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "imported []\n" in done.stdout
