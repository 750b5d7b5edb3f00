"""Round trips through a program against the clock: ``devices.py device-udp python``.

A peer sends a number, a process takes it as an event and writes it back, and the peer takes that: the median of 300
round trips, in microseconds. The peer is a socket, the other end of a pseudo-terminal, or another node of a CAN bus by
multicast.
"""

from __future__ import annotations

import os
import pty
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from timing import BATCHES, report, requested_benchmark

TRIPS = 300
PATIENCE = 10.0
"""Seconds until the program answers first."""

PROGRAM = """driver Peer({parameters}) device "{device}" {{ out x : double  in y : double }}
process Echo {{
  in x : double
  out y : double
  communication {{ var v : double }}
  composition {{ mu (x ? v ; y ! v) }}
}}
environment World for Echo step 100 us {{ peer : Peer({arguments})  peer.x -> x  y -> peer.y }}
"""

DBC = """VERSION ""
NS_ :
BS_:
BU_: Board Host
BO_ 256 Sent: 8 Board
 SG_ x : 0|32@1+ (1,0) [0|4294967295] "" Host
BO_ 512 Answered: 8 Host
 SG_ y : 0|32@1+ (1,0) [0|4294967295] "" Board
"""

Exchange = Callable[[int, float], bool]
"""Sends a number, and says whether it has come back within some seconds."""


def by_udp(_: Path) -> tuple[str, str, Exchange]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    own.bind(("127.0.0.1", 0))

    def exchange(number: int, seconds: float) -> bool:
        own.sendto(b'{"x": %d}' % number, ("127.0.0.1", port))
        while select.select([own], [], [], seconds)[0]:
            if b"%d" % number in own.recv(1000):
                return True
        return False

    return "port: int", f"port = {port}", exchange


def by_serial(_: Path) -> tuple[str, str, Exchange]:
    master, slave = pty.openpty()
    tty.setraw(slave)
    path = os.ttyname(slave)

    def exchange(number: int, seconds: float) -> bool:
        os.write(master, b"x %d\n" % number)
        answer = b""
        while select.select([master], [], [], seconds)[0]:
            answer += os.read(master, 1000)
            if b"y %d" % number in answer and answer.endswith(b"\n"):
                return True
        return False

    return "path: text", f'path = "{path}"', exchange


def by_can(folder: Path) -> tuple[str, str, Exchange]:
    try:
        import can

        group = f"239.74.163.{os.getpid() % 200 + 10}"
        bus = can.Bus(interface="udp_multicast", channel=group)
    except (ImportError, OSError):
        sys.exit(0)
    (folder / "echo.dbc").write_text(DBC)

    def exchange(number: int, seconds: float) -> bool:
        bus.send(can.Message(arbitration_id=256, is_extended_id=False, data=number.to_bytes(4, "little") + bytes(4)))
        until = time.perf_counter() + seconds
        while (left := until - time.perf_counter()) > 0:
            frame = bus.recv(left)
            if frame is not None and frame.arbitration_id == 512 and int.from_bytes(frame.data[:4], "little") == number:
                return True
        return False

    return (
        "dbc: text, interface: text, bus: text",
        f'dbc = "{folder}/echo.dbc", interface = "udp_multicast", bus = "{group}"',
        exchange,
    )


PEERS = {"udp": by_udp, "serial": by_serial, "can": by_can}


@contextmanager
def running(text: str, folder: Path) -> Iterator[None]:
    path = folder / "echo.csp"
    path.write_text(text)
    command = [sys.executable, "-m", "cspdiag", "run", "--real-time", "--quiet", str(path)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(20)


def main(device: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        parameters, arguments, exchange = PEERS[device](folder)
        text = PROGRAM.format(device=device, parameters=parameters, arguments=arguments)
        with running(text, folder):
            number = 1
            until = time.perf_counter() + PATIENCE
            while not exchange(number, 0.2):
                number += 1
                if time.perf_counter() > until:
                    sys.exit(f"the program does not answer by {device}")
            for _ in range(BATCHES):
                taken = []
                for _ in range(TRIPS):
                    number += 1
                    began = time.perf_counter_ns()
                    if exchange(number, 1.0):
                        taken.append(time.perf_counter_ns() - began)
                report(median(taken) / 1e3)


main(requested_benchmark().rpartition("-")[2])
