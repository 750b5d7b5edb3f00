"""The C target refuses programs with parts in Python, and reports all such parts at once."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.codegen.c.package.refusals import refuse, refuse_devices
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork

PROGRAM = """
submodel Filter python "laws/filter.py:Filter" {
  in  x : double
  out y : double
}

submodel Smooth {
  in  x : double
  out y : double
  filter : Filter
  filter.x = x
  y = filter.y
}

process Logger python "logger.py:Logger" {
  in y : double
}

process Top {
  in x : double @ 1 ms
  communication {
    smooth : Smooth
    logger : Logger
    x -> smooth.x
    smooth.y -> y : double -> logger.y
  }
  composition { (mu smooth) || logger }
}

driver Stick python "stick.py:Stick" {
  out x : double
}

environment Real for Top {
  stick : Stick
  stick.x -> x
}
"""


def network(text: str) -> CoreNetwork:
    built = pipeline.build(SourceFile(name="rig.csp", text=text), lambda path: SourceFile(name=path, text=""))
    assert built.network is not None
    return built.network


def test_every_part_in_python_is_named_with_its_place_and_a_help() -> None:
    with pytest.raises(TargetError) as refusal:
        refuse(network(PROGRAM))
    assert str(refusal.value).splitlines() == [
        "rig.csp:15: the body of the process `Logger` is a Python class (logger.py:Logger), which C cannot call",
        '  help: write it in the language, or in C: `process Logger c "logger.c"`',
        "rig.csp:2: the body of the submodel `Filter` is a Python class (laws/filter.py:Filter), which C cannot call",
        '  help: write it in the language, or in C: `submodel Filter c "filter.c"`',
    ]


def test_the_devices_of_an_environment_are_refused_where_it_is_to_run() -> None:
    with pytest.raises(TargetError, match=r"rig.csp:30: the driver `Stick` is a Python class \(stick.py:Stick\)"):
        refuse_devices(network(PROGRAM).environments[0])


def test_bodies_in_c_are_accepted() -> None:
    text = PROGRAM.replace('python "logger.py:Logger"', 'c "logger.c"').replace(
        'python "laws/filter.py:Filter"', 'c "filter.c"'
    )
    refuse(network(text[: text.index("driver")]))
