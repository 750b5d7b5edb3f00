"""Laws that are computed in their process: what remains of their communication, also for laws with
hand-written parts.
"""

from __future__ import annotations

from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    ReadInputs,
    ResetStates,
    RunInstance,
    RunLaw,
    SequentialSteps,
    WriteOutputs,
)
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize import optimize, pass_named
from tests.network import programs


def inlined(text: str) -> Network:
    names = ("specialize", "variables", "inline_laws")
    return optimize(programs.network(text), [pass_named(name) for name in names])


def steps_after_run(network: Network) -> list[type[Action]]:
    """The actions around the law of ``Main``."""
    body = programs.process(network, "Main").body
    sequence = next(part for part in parts(body) if isinstance(part, SequentialSteps))
    return [type(step) for step in sequence.steps]


VARIABLES = """
submodel Half { in u : double  out y : double  y = 0.5 * u }
process Main {
  out force : double @ 1 ms
  communication { var x : double = 8  half : Half  x -> half.u  half.y -> x }
  composition { mu (half ; BEFORE force ! x ; wait 1 ms) AFTER }
}
"""


def test_a_law_between_variables_computes() -> None:
    network = inlined(VARIABLES.replace("BEFORE", "").replace("AFTER", ""))
    assert steps_after_run(network)[:2] == [RunLaw, AssignValue]


def test_a_law_is_a_point_of_cancellation_where_that_can_be_seen() -> None:
    text = (
        VARIABLES.replace("mu (", "(mu (")
        .replace("AFTER", ") interrupt after 20 ms -> force ! x")
        .replace("BEFORE", "")
    )
    assert steps_after_run(inlined(text))[:3] == [ReadInputs, RunLaw, AssignValue]


HAND = """
submodel Friction python "friction.py:Friction" { in w : double  out torque : double }
submodel Joint(gain: double) {
  in u : double
  out y : double
  friction : Friction
  state w : double = 0
  friction.w = u
  y = gain * w - friction.torque
  next w = w + u
}
process Main {
  in u : double @ 1 ms
  out y : double @ 1 ms
  communication { joint : JOINT  u -> joint.u  joint.y -> y }
  composition { mu (joint ; reset joint) }
}
"""


def test_a_part_written_by_hand_is_called_and_reset() -> None:
    text = HAND.replace("JOINT", "Joint(gain = 2)")
    main = programs.process(inlined(text), "Main")
    (call,) = [part for part in parts(main.body) if isinstance(part, ExternalCall)]
    assert call.name == "joint.friction"
    assert [local for _, local, _ in call.outputs] == ["joint.friction.torque"]
    (reset,) = [part for part in parts(main.body) if isinstance(part, ResetStates)]
    assert reset.states == ("joint.w", "joint.friction")


def test_a_law_written_by_hand_stays() -> None:
    text = HAND.replace("JOINT", "Friction").replace("joint.u", "joint.w").replace("joint.y", "joint.torque")
    network = inlined(text)
    main = programs.process(network, "Main")
    assert [part.instance for part in parts(main.body) if isinstance(part, RunInstance)] == ["joint"]
    assert [entry.name for entry in network.classes] == ["Friction", "Main"]


def test_inputs_and_outputs_keep_the_order_of_the_ports() -> None:
    network = inlined("""
submodel Mix { in c : double  in a : double  in b : double  out z : double  out y : double
  z = a + b
  y = a - b + c }
process Main {
  in a : double @ 1 ms
  in b : double @ 1 ms
  out y : double @ 1 ms
  communication { var seen : double  mix : Mix  a -> mix.b  b -> mix.a  a -> mix.c  mix.z -> seen  mix.y -> y }
  composition { mu mix }
}
""")
    main = programs.process(network, "Main")
    (reads,) = [part.reads for part in parts(main.body) if isinstance(part, ReadInputs)]
    assert [read.name for read in reads] == ["mix.c", "mix.a", "mix.b"]
    assert len({read.source for read in reads}) == 3
    (writes,) = [part.writes for part in parts(main.body) if isinstance(part, WriteOutputs)]
    assert len(writes) == 2


def test_arrays_of_laws_have_names_of_their_own() -> None:
    network = inlined("""
submodel Sum { in u : int  out y : int  state x : int = 0  next x = x + u  y = x }
process Main {
  in u : int @ 1 ms
  out y[3] : int @ 1 ms
  communication { sum[3] : Sum  for i < 3 { u -> sum[i].u  sum[i].y -> y[i] } }
  composition { mu (par i < 3 : sum[i]) }
}
""")
    main = programs.process(network, "Main")
    assert [state.name for state in main.states] == ["sum[0].x", "sum[1].x", "sum[2].x"]
    assert main.instances == ()
    assert all(isinstance(entry, ProcessClass) for entry in network.classes)
