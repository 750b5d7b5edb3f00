"""Why a native program does not make a change of a parameter."""

from __future__ import annotations

import pytest

from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.pipeline import build
from cspdiag.runtime.kernel.parameters import Change
from cspdiag.semantics.equations import parameters as semantics
from cspdiag.simulate.native.tuning import Refusals

PROGRAM = """\
parameter gain : double = 2
const inverse = 1 / (gain - 3)

process Amplifier {
  in  x : double @ 10 ms
  out y : double @ 10 ms
  communication { var v : double }
  composition { mu (x ? v ; y ! inverse * v) }
}
"""


def refusals() -> Refusals:
    network = build(SourceFile(name="amplifier.csp", text=PROGRAM), read_source).network
    assert network is not None
    return Refusals(network)


def test_the_reason_is_that_of_the_reference_semantics() -> None:
    found = refusals()
    found.made(Change(0, "gain", (), 4.0))
    assert found.reason(Change(1, "gain", (), float("inf"))) == "inf is not finite"
    assert found.reason(Change(2, "gain", (), 3.0)) == "division by zero"
    found.made(Change(3, "gain", (), 5.0))
    assert found.reason(Change(4, "gain", (), 3.0)) == "division by zero"


def test_each_change_is_made_once_however_many_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    made = 0
    make = semantics.Parameters._make

    def counted(self: semantics.Parameters, change: semantics.Change) -> str:
        nonlocal made
        made += 1
        return make(self, change)

    monkeypatch.setattr(semantics.Parameters, "_make", counted)
    found = refusals()
    for number in range(200):
        found.made(Change(number, "gain", (), 4.0 + number))
        assert found.reason(Change(number, "gain", (), 3.0)) == "division by zero"
    assert made == 400
