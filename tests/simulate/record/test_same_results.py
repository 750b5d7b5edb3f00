"""What a run gives to Python programs is the same wherever the program runs."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum

import pytest

import cspdiag

LEVELS: list[Mapping[str, object]] = [
    {"level": 0},
    {"level": 1},
    {"target": "c"},
    {"target": "c", "level": 0},
    {"target": "auto"},
    {"level": "reference"},
]

TYPES = """\
enum Gear { park, drive }

struct Pose {
  angle : double
  gear  : Gear
}

process Main {
  in  x     : double  @ 1 ms
  out gear  : Gear    @ 1 ms
  out poses : Pose[2] @ 1 ms

  communication {
    var last : double
  }

  composition {
    mu (
      x ? last ;
      gear ! Gear.drive ;
      poses ! [Pose(last, Gear.park), Pose(0.5, Gear.drive)]
    )
  }
}

submodel Ramp {
  out x : double

  x = 0.25
}

environment Bench for Main {
  ramp : Ramp

  ramp.x -> x
  gear   -> _
  poses  -> _
}
"""


@pytest.mark.parametrize("options", LEVELS, ids=str)
def test_enums_and_structs_have_their_names(options: Mapping[str, object]) -> None:
    run = cspdiag.parse(TYPES, "types.csp").run(until=0.003, **options)  # type: ignore[arg-type]
    values = {each.channel: each.value for each in run.communications}
    gear, poses = values["Main.gear"], values["Main.poses"]
    assert isinstance(gear, IntEnum)
    assert (gear.name, type(gear).__name__) == ("drive", "Gear")
    assert poses == ((0.25, 0), (0.5, 1))
    first = poses[0]  # type: ignore[index]
    assert (first.angle, first.gear.name, type(first).__name__) == (0.25, "park", "Pose")


STUCK = """\
submodel Law {
  in  x : double
  out y : double

  y = x
}

process Part {
  in  x : double
  out y : double

  communication {
    var last : double
  }

  composition {
    x ? last ; y ! last
  }
}

process Main {
  communication {
    part : Part
    law  : Law

    part.y -> law.x
    law.y  -> part.x
  }

  composition {
    part || law
  }
}

environment Bench for Main {
}
"""


@pytest.mark.parametrize("options", LEVELS, ids=str)
def test_waiting_processes_say_where_they_are_defined(options: Mapping[str, object]) -> None:
    run = cspdiag.parse(STUCK, "stuck.csp").run(**options)  # type: ignore[arg-type]
    report = run.outcome.deadlock
    assert report is not None
    defined = {"Main.part": "stuck.csp:8", "Main.law": "stuck.csp:1", "Main": "stuck.csp:21"}
    assert [each.source for each in report.waiting] == [defined[each.path] for each in report.waiting]
    assert "Main.part" in [each.path for each in report.waiting]
    assert len(report.waiting) == 2
