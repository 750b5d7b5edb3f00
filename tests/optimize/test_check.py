"""A network that a pass has broken is refused, with the name of the pass and of the broken part."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest

from cspdiag.base.record import replaced
from cspdiag.cli.main import main
from cspdiag.model.types import BOOL, INT
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import BinaryOperation, LiteralValue, ParameterValue, VariableValue
from cspdiag.network.ir.network import Connection, InstanceOf, LocalChannel, Network, Port, SubmodelState
from cspdiag.optimize import PASSES, Pass, optimize
from cspdiag.optimize.check.network import MADE_BY, BrokenNetworkError, require_valid
from tests.network import programs

TEXT = """
exception Odd
submodel Law(gain : double = 2.0) {
  in u : double
  out y : double
  state s : double = 0.0
  y = gain * s
  next s = s + u
}
process Cell(limit : int) {
  in a[2] : int
  out b : int
  communication { var x : int  var many : int[3] = [1, 2, 3] }
  composition {
    mu (
      ( (a[0] ? x -> skip) [] (a[1] ? x -> skip) [] (after 3 ms -> x := limit) ) ;
      many[x] := x + 1 ;
      ((if x > 3 then raise Odd else wait 1 ms) catch Odd -> b ! many[0])
    )
  }
}
process Feed { in b : int  out a[2] : int  communication { var x : int }
  composition { mu (a[0] ! 1 ; a[1] ! 2 ; b ? x) } }
process Main {
  in u : double @ 10 ms
  out y : double
  communication {
    cell : Cell(4)
    feed : Feed
    law : Law
    feed.a -> cell.a
    cell.b -> feed.b
    u -> law.u
    law.y -> y
  }
  composition { cell || feed || mu law }
}
"""


def network() -> Network:
    return programs.network(TEXT)


def each(kind: type, change: Callable[[Any], Any]) -> Callable[[Network], Network]:
    """The network with every record of a kind changed."""
    return lambda whole: rewritten(whole, lambda item: change(item) if isinstance(item, kind) else item)


def fields(kind: type, **values: object) -> Callable[[Network], Network]:
    return each(kind, lambda item: replaced(item, **values))


BROKEN: dict[str, tuple[Callable[[Network], Network], str]] = {
    "no such port": (fields(ir.PortEnd, port="nowhere"), "there is no port `nowhere`"),
    "no such element": (fields(ir.PortEnd, index=7), "has no element 7"),
    "read of an output": (
        each(ir.ReadValue, lambda read: replaced(read, source=ir.PortEnd("a", 0))),
        "the port `a` is of the other direction",
    ),
    "no such channel": (fields(ir.ChannelEnd, channel="lost"), "there is no channel `lost`"),
    "no such variable": (fields(ir.Target, channel="lost"), "there is no variable `lost`"),
    "assignment of another type": (
        fields(ir.AssignValue, value=LiteralValue(type=BOOL, value=True)),
        "`many` is int and is given bool",
    ),
    "no such instance": (fields(ir.RunInstance, instance="lost"), "there is no instance `lost`"),
    "no such exception": (fields(ir.RaiseException, exception="Lost"), "there is no exception `Lost`"),
    "nothing to catch": (fields(ir.CatchException, exception="Lost"), "there is no exception `Lost`"),
    "delay that is no time": (
        fields(ir.WaitStep, duration=LiteralValue(type=INT, value=1)), "is int where time is needed"
    ),
    "condition that is none": (
        fields(ir.IfElse, condition=LiteralValue(type=INT, value=1)), "is int where bool is needed"
    ),
    "no place": (fields(ir.AssignValue, span=None), "AssignValue has no place in the text"),
    "alternative of nothing": (fields(ir.Choice, branches=()), "an alternative has no branches"),
    "value of another type": (fields(LiteralValue, value="text"), "is not of type int"),
    "parameter that is not declared": (fields(ParameterValue, name="lost"), "names no parameter"),
    "variable that is not declared": (fields(VariableValue, channel="lost"), "names no variable"),
    "variable of another type": (fields(VariableValue, type=BOOL), "has bool where int is needed"),
    "operands that differ": (
        each(BinaryOperation, lambda sum: replaced(sum, right=LiteralValue(type=BOOL, value=True))),
        "has bool where int is needed",
    ),
    "class that is not there": (fields(InstanceOf, class_name="Lost"), "the class `Lost`"),
    "argument that is missing": (fields(InstanceOf, arguments=()), "the arguments of `cell` are not the parameters"),
    "port that is not connected": (fields(InstanceOf, connections=()), "the connections of `cell` are not the ports"),
    "connection the other way": (
        each(Connection, lambda end: replaced(end, port="b" if end.port == "a" else end.port)),
        "the connections of `cell`"
    ),
    "channel of another type": (fields(LocalChannel, type=BOOL), "and connected to bool"),
    "state that is missing": (
        each(SubmodelState, lambda state: replaced(state, name="lost")), "there is no state `s`"
    ),
    "two of one name": (lambda whole: replaced(whole, classes=(*whole.classes, whole.classes[-1])),
     "there are 2 declarations of the class"),
    "classes the wrong way round": (
        lambda whole: replaced(whole, classes=whole.classes[::-1]), "is not before it"
    ),
    "instance that is not there": (
        lambda whole: replaced(whole, instances=whole.instances[:1]), "`Main.cell` is not listed"
    ),
    "no outermost process": (lambda whole: replaced(whole, top="Law"), "the outermost process `Law` is not a process"),
    "step of a pass that has not been": (
        each(ir.SkipStep,
         lambda skip: ir.ProcessScope(span=skip.span, instance="x", class_name="X", ends=(), body=skip)),
        "ProcessScope is there before the pass `flatten`",
    ),
}  # fmt: skip


def test_every_step_that_is_in_no_text_has_its_pass() -> None:
    assert MADE_BY.keys() == set(get_args(ir.MadeAction))
    assert set(MADE_BY.values()) <= {entry.name for entry in PASSES}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_network_is_refused(name: str) -> None:
    damage, expected = BROKEN[name]
    breaking = Pass(name="breaking", description="Breaks the network.", apply=damage)
    with pytest.raises(BrokenNetworkError) as caught:
        optimize(network(), (breaking,), debug=True)
    assert expected in str(caught.value)
    assert "broken after breaking" in str(caught.value)


@pytest.mark.parametrize(
    ("damage", "expected"),
    [(fields(Port, media=()), "does not say what it is connected to"), (fields(ir.Choice, name=""), "has no name")],
)
def test_what_a_pass_establishes_is_checked_after_later_passes(
    damage: Callable[[Network], Network], expected: str
) -> None:
    breaking = Pass(name="breaking", description="Breaks the network.", apply=damage)
    with pytest.raises(BrokenNetworkError, match=expected):
        optimize(network(), (PASSES[0], breaking), debug=True)
    optimize(network(), (PASSES[0],), debug=True)


def test_a_whole_network_is_taken() -> None:
    whole = network()
    require_valid(whole)
    assert optimize(whole, debug=True) == optimize(whole)


def test_the_command_line_verifies_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "cell.csp"
    program.write_text(TEXT)
    arguments = ["compile", str(program), "-o", str(tmp_path), "--debug-passes"]
    assert main(arguments) == 0
    breaking = Pass(name="breaking", description="Breaks the network.", apply=fields(ir.PortEnd, port="nowhere"))
    monkeypatch.setattr("cspdiag.optimize.PASSES", (*PASSES[:1], breaking))
    assert main(arguments) == 3
    assert "broken after breaking: Cell: there is no port `nowhere`" in capsys.readouterr().err
