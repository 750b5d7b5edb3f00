"""The table of ports in generated C."""

from __future__ import annotations

import re

from cspdiag import pipeline
from cspdiag.base import SourceFile
from tests.conformance.sources import network_of, read


def rows(table: str) -> list[tuple[str, str]]:
    """The name of each port, and what its row says besides."""
    entries = re.findall(r'\.name = "P\.(\w+)"([^}]*)', table)
    return [(name, rest) for name, rest in entries]


def test_neighbouring_ports_with_the_same_ticks_share_a_test_of_them() -> None:
    text = """
        process P {
          in  a : double @ 1 ms
          in  b : double @ 1 ms
          in  c : double @ 1 ms offset 200 us
          in  d : double @ 2 ms
          out e : double @ 2 ms
          out f : double @ 2 ms
          out g : double @ 2 ms
          in  h : double @ 2 ms
          composition { skip }
        }
    """
    source = pipeline.generate(network_of(SourceFile(name="ports.csp", text=text)), read, "c")["network.c"]
    table = source.partition("port_table[] = {")[2].partition("};")[0]
    alike = {name: int(found[1]) if (found := re.search(r"alike = (\d+)U", row)) else 0 for name, row in rows(table)}
    assert alike == {"a": 1, "b": 0, "c": 0, "d": 0, "e": 2, "f": 1, "g": 0, "h": 0}
