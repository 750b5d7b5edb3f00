"""Processes that take the places of a program, on the loopback."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

PAIR = """
enum Light { red, green }

struct Order { count: int  share: double  light: Light }

process Source {
  out sent : Order
  communication { var order : Order = Order(count = 0, share = 0.1, light = Light.green) }
  composition {
    mu (
      wait 10 ms ;
      order := Order(count = order.count + 1, share = order.share / 3, light = Light.red) ;
      (sent ! order catch Timeout -> wait 1 ms)
    ) until order.count == LAST
  }
}

process Sink {
  in  received : Order
  out value    : int @ 10 ms safe 7
  communication { var order : Order = Order(count = 0, share = 0.0, light = Light.green)  var timeouts : int = 0 }
  composition {
    mu ((received ? order ; value ! order.count) HANDLED) until order.count == LAST
  }
}

process Pair {
  out value : int @ 10 ms safe 7
  communication {
    source : Source
    sink   : Sink
    source.sent -> sink.received
    sink.value  -> value
  }
  composition { source || sink }
}

environment Bench for Pair step 10 ms place left : source place right : sink { value -> _ }
"""


def pair(last: int, handled: str = "") -> str:
    """A source in one place, whose orders a sink in another one counts; ``handled`` is what it catches."""
    return PAIR.replace("LAST", str(last)).replace("HANDLED", handled)


def free_port() -> int:
    """A port of the loopback that nobody listens at."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start() -> Iterator[Start]:
    """Starts ``cspdiag run FILE --place NAME@127.0.0.1:PORT``; what is left is killed at the end."""
    pytest.importorskip("zenoh")
    started: list[subprocess.Popen[str]] = []

    def begin(
        file: Path, place: str, port: int, *options: object, program: Sequence[str] = (sys.executable, "-m", "cspdiag")
    ) -> subprocess.Popen[str]:
        command = ["run", str(file), "--place", f"{place}@127.0.0.1:{port}", *map(str, options)]
        process = subprocess.Popen(
            [*program, *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        started.append(process)
        return process

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    """The exit code and the output of a process that ends."""
    output, _ = process.communicate(timeout=60)
    return process.returncode, output
