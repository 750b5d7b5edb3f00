"""A small closed loop: a heater with a thermostat, two modes, an event, a struct and an enum among its channels."""

from __future__ import annotations

from pathlib import Path

import pytest

HEATER = """
enum Demand { off, low, high }

/// Heats until the button is pressed, then holds the door shut for a while.
process Heat {
    in  temperature : double<K> @ 10 ms
    in  button      : int
    out power       : double<W> @ 10 ms
    out demand      : Demand

    communication {
        var pressed : int = 0
        var now     : double<K> = 0
    }

    composition {
        (mu (button ? pressed -> skip
             []>
             temperature ? now -> (power ! (if now < 310<K> then 50<W> else 5<W>) ;
                                   demand ! (if now < 310<K> then Demand.high else Demand.low)))
         until pressed == 1) ;
        power ! 0<W>
    }
}

process Log {
    in demand : Demand
    communication { var last : Demand = Demand.off }
    composition { (mu demand ? last) interrupt after 480 ms -> skip }
}

process Cool {
    composition { wait 25 ms }
}

process Oven {
    in  temperature : double<K> @ 10 ms
    in  button      : int
    out power       : double<W> @ 10 ms

    communication {
        heat : Heat
        cool : Cool
        log  : Log

        temperature -> heat.temperature
        button      -> heat.button
        heat.power  -> power
        heat.demand -> demand -> log.demand
    }

    composition { work: (heat ; cool) || log }
}

submodel Chamber(ambient: double<K> = 290<K>) {
    in  power       : double<W>
    out temperature : double<K>
    out button      : int

    state t : double<K> = ambient
    der t = (power / 1<W> * 20<K> - (t - ambient)) / 1<s>
    temperature = t
    button = if time > 0.4<s> then 1 else 0
}

environment Bench for Oven step 5 ms {
    chamber : Chamber

    power               -> chamber.power
    chamber.temperature -> temperature
    chamber.button      -> button
}
"""


@pytest.fixture
def heater(tmp_path: Path) -> Path:
    folder = tmp_path / "a folder"
    folder.mkdir()
    path = folder / "heater.csp"
    path.write_text(HEATER)
    return path
