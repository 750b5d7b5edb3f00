"""Serves an assistant on standard input and output, until it ends the connection or a signal ends the server."""

from __future__ import annotations

import asyncio
import os
import signal
from pathlib import Path

from cspdiag.assistants import commands
from cspdiag.assistants.server import server

_ENDING = [signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


def serve(path: Path) -> None:
    """Serve the programs of a folder. When the connection ends, or by Ctrl-C, SIGTERM or SIGHUP, the commands that are
    carried out are ended first, as by Ctrl-C.
    """
    asyncio.run(_serve(path))


async def _serve(path: Path) -> None:
    received: asyncio.Queue[signal.Signals] = asyncio.Queue()
    loop = asyncio.get_running_loop()
    for number in _ENDING:
        loop.add_signal_handler(number, received.put_nowait, number)
    serving = asyncio.ensure_future(server(path).run_stdio_async())
    waiting = asyncio.ensure_future(received.get())
    await asyncio.wait((serving, waiting), return_when=asyncio.FIRST_COMPLETED)
    if serving.done():
        waiting.cancel()
        await serving
        return
    await commands.end_all()
    # The sender sees that the signal has ended this process. The usual end would wait for the thread that reads
    # standard input, which nothing can wake.
    signal.signal(waiting.result(), signal.SIG_DFL)
    os.kill(os.getpid(), waiting.result())
