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


def test_headers_state_units_and_periods() -> None:
    text = """
        struct Gains { gain : double<V/m>  filter : time  limit : double }
        /// Gains of the controller.
        parameter gains : Gains = Gains(gain = 1<V/m>, filter = 1 ms, limit = 2)
        /// Set-point of the valve. It is kept.
        parameter setPoint : double<m> = 1<m>
        process Valve {
          /// Pressure behind the valve.
          in  pressure : double<Pa> @ 10 ms
          in  level    : double<m>[2] @ 10 ms offset 2 ms
          /// Time until it closes.
          in  closing  : time
          out flow     : double<m^3/s> @ 5 ms
          out count    : int
          composition { skip }
        }
    """
    package = pipeline.generate(network_of(SourceFile(name="valve.csp", text=text)), read, "c")
    api, types = package["valve_api.h"], package["valve_types.h"]
    assert "double pressure; /* Pressure behind the valve, in Pa, every 10 ms. */" in api
    assert "level; /* In m, every 10 ms with an offset of 2 ms. */" in api
    assert "/* Time until it closes, in nanoseconds. */\nbool valve_closing(" in api
    assert "double flow; /* In m^3/s, every 5 ms. */" in api
    assert "int64_t count;\n" in api
    assert "double gain; /* In V/m. */\n    int64_t filter; /* In nanoseconds. */\n    double limit;\n" in types
    assert "struct valve_gains gains; /* Gains of the controller. */" in types
    assert "double setPoint; /* Set-point of the valve. It is kept. In m. */" in types
