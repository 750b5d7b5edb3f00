"""Processes of places whose connections cannot be closed in time."""

from __future__ import annotations

import sys
from pathlib import Path

from tests.simulate.hosts.conftest import Start, ended, free_port, pair

SLOW = """
import sys
from cspdiag.__main__ import main
from cspdiag.simulate.hosts import network

def close(session):
    # A thread that is in the library, where it cannot be ended, as when a firewall answers nothing.
    import zenoh
    never = network._config(zenoh, mode="client", **{"connect/endpoints": ["tcp/127.0.0.1:1"], "connect/timeout_ms": 1})
    while True:
        try:
            zenoh.open(never)
        except zenoh.ZError:
            pass

network._close = close
sys.exit(main())
"""


def test_a_connection_that_cannot_be_closed_does_not_change_how_a_process_ends(start: Start, tmp_path: Path) -> None:
    file, slow, port, trace = tmp_path / "pair.csp", tmp_path / "slow.py", free_port(), tmp_path / "right.jsonl"
    file.write_text(pair(20))
    slow.write_text(SLOW)
    left = start(file, "left", port)
    right = start(file, "right", port, "--trace", trace, program=[sys.executable, str(slow)])
    results = [ended(left), ended(right)]
    assert [code for code, _ in results] == [0, 0], results
    assert results[1][1].rstrip().endswith(f"wrote {trace}")
