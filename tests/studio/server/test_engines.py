"""The processes of engines, however they end."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

from cspdiag.studio.server.engines import EngineProcess

CUT = """\
import os, sys, time
print('{"id": 1, "result": 3}', flush=True)
sys.stdin.read()
os.write(1, b'{"method": "fra')
os.close(1)
time.sleep(0.2)
open('released', 'w').close()
"""


def test_an_engine_that_is_cut_off_in_a_message_still_releases_its_outputs(tmp_path: Path) -> None:
    async def run() -> None:
        engine = EngineProcess([sys.executable, "-c", CUT], str(tmp_path))
        assert (await engine.request("state", {}))["result"] == 3
        await engine.end()

    asyncio.run(run())
    assert (tmp_path / "released").exists()
