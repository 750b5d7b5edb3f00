"""The processes of engines, however they end."""

from __future__ import annotations

import asyncio
import os
import pty
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

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


KEYS = """\
driver Keys device "keyboard" { out x : double }
process Main {
  in  x     : double @ 10 ms
  out level : double @ 10 ms safe 0
  communication { var v : double = 0 }
  composition { mu (x ? v ; level ! v) }
}
environment Hand for Main on miss count { keys : Keys  keys.x -> x  level -> _ }
"""
SERVER = """\
import asyncio, fcntl, os, signal, sys, termios
from cspdiag.studio.server.engines import ENGINE, EngineProcess

async def run():
    moved = asyncio.Event()

    def notified(text, message):
        if message["method"] == "ended" and not moved.is_set():
            sys.exit(message["params"]["text"])
        values = message["params"].get("signals", {}).get("x", {"v": []})["v"]
        if any(value > 0.1 for value in values):
            moved.set()

    engine = EngineProcess(ENGINE, os.getcwd(), notified, uses_terminal=True)
    program = {"files": {"a.csp": sys.argv[1]}, "main": "a.csp"}
    answer = await engine.request("start", {**program, "environment": "Hand", "real_time": True})
    print(answer.get("error", "started"), flush=True)
    await asyncio.wait_for(moved.wait(), 20)
    print("moved", flush=True)
    if sys.argv[2] == "killed":
        os.kill(engine._process.pid, signal.SIGKILL)
        await engine._reader
    await engine.end()

fcntl.ioctl(0, termios.TIOCSCTTY, 0)
asyncio.run(run())
"""


@pytest.mark.parametrize("how", ["ended", "killed"])
def test_the_keys_of_the_terminal_of_the_server_reach_programs(tmp_path: Path, how: str) -> None:
    terminal, its_own = pty.openpty()
    command = [sys.executable, "-c", SERVER, KEYS, how]
    streams = {"stdin": its_own, "stdout": its_own, "stderr": its_own}
    server = subprocess.Popen(command, cwd=tmp_path, start_new_session=True, **streams)
    said = b""
    try:
        while b"moved" not in said and (data := os.read(terminal, 1000)):
            said += data
            if b"started" in data:
                while termios.tcgetattr(terminal)[3] & termios.ECHO:
                    time.sleep(0.01)
                os.write(terminal, b"\x1b[C\x1b[C")
        assert b"moved" in said, said.decode()
        assert server.wait() == 0
        assert termios.tcgetattr(terminal)[3] & termios.ECHO
    finally:
        server.kill()
        server.wait()
        os.close(terminal)
        os.close(its_own)


def test_an_engine_that_is_cut_off_in_a_message_still_releases_its_outputs(tmp_path: Path) -> None:
    async def run() -> None:
        engine = EngineProcess([sys.executable, "-c", CUT], str(tmp_path))
        assert (await engine.request("state", {}))["result"] == 3
        await engine.end()

    asyncio.run(run())
    assert (tmp_path / "released").exists()
