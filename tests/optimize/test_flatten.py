"""What moves up when a process that runs in sequence is flattened, and what does not."""

from __future__ import annotations

from cspdiag.network.analyse import DEEPEST_PROCESSES
from cspdiag.network.ir.actions import PortEnd, ProcessScope, RunInstance
from cspdiag.network.ir.expressions import ParameterValue
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize import optimize, pass_named
from cspdiag.optimize.flatten.processes import LARGEST, LONGEST
from cspdiag.syntax.parse.nesting import MAX_DEPTH
from tests.network import programs


def flattened(text: str) -> Network:
    return optimize(programs.network(text), [pass_named("specialize"), pass_named("flatten")])


def scopes(entry: ProcessClass) -> list[str]:
    return [part.instance for part in parts(entry.body) if isinstance(part, ProcessScope)]


def runs(entry: ProcessClass) -> list[str]:
    return [part.instance for part in parts(entry.body) if isinstance(part, RunInstance)]


CELL = """
process Cell { out y : int  communication { var n : int = 0 }  composition { n := n + 1 ; y ! n } }
"""


def test_levels_of_processes_become_one() -> None:
    network = flattened(
        CELL
        + """
process Pair {
  out y : int
  communication { left : Cell  right : Cell  left.y, right.y -> y }
  composition { left ; right }
}
process Main { out y : int  communication { pair : Pair  pair.y -> y }  composition { mu (pair ; wait 1 ms) } }
"""
    )
    (main,) = network.classes
    assert isinstance(main, ProcessClass)
    assert scopes(main) == ["pair", "pair.left", "pair.right"]
    assert [channel.name for channel in main.channels] == ["pair.left.n", "pair.right.n"]
    assert [instance.path for instance in network.instances] == ["Main"]


def test_a_long_array_stays_an_array() -> None:
    text = (
        CELL
        + """
process Main {
  out y : int
  communication { cell[COUNT] : Cell  for i < COUNT { cell[i].y -> y } }
  composition { mu ((seq i < COUNT : cell[i]) ; wait 1 ms) }
}
"""
    )
    short = programs.process(flattened(text.replace("COUNT", str(LONGEST))), "Main")
    assert scopes(short) == [f"cell[{index}]" for index in range(LONGEST)]
    long = programs.process(flattened(text.replace("COUNT", str(LONGEST + 1))), "Main")
    assert scopes(long) == []
    assert runs(long) == [f"cell[{index}]" for index in range(LONGEST + 1)]


def test_classes_that_share_classes_do_not_grow_without_bounds() -> None:
    levels = 14
    text = "process P0(n: int) { out y : int  composition { y ! n } }\n"
    for level in range(1, levels):
        text += f"""
process P{level}(n: int) {{
  out y : int
  communication {{ var k : int = n + n  a : P{level - 1}(n = n + n)  b : P{level - 1}(n = n)  a.y, b.y -> y }}
  composition {{ a ; y ! k ; b }}
}}
"""
    text += (
        f"process Main {{ out y : int  communication {{ p : P{levels - 1}(n = 0)  p.y -> y }}  composition {{ p }} }}\n"
    )
    network = flattened(text)
    assert len(network.classes) > 1
    assert all(
        sum(1 for _ in parts(entry.body)) <= LARGEST for entry in network.classes if isinstance(entry, ProcessClass)
    )


def test_objects_created_with_a_process_depend_on_its_parameters_only() -> None:
    """These are arguments of instances and initial values of variables; what a run computes is a constant of
    the class.
    """
    network = flattened("""
process Other(size: int) { out y : int  composition { mu (y ! size ; wait 1 ms) } }
process Inner(size: int) {
  out y : int
  out z : int
  communication { var x : int = size + 1  other : Other(size = size * size)  other.y -> y }
  composition { (z ! size + x) ; (other || wait 5 ms) }
}
process Main(size: int = 4) {
  out y : int
  out z : int
  communication { inner : Inner(size = size + 2)  inner.y -> y  inner.z -> z }
  composition { inner }
}
""")
    main = programs.process(network, "Main")
    (other,) = main.instances
    at_creation = [part for part in parts((other.arguments, main.channels)) if isinstance(part, ParameterValue)]
    assert {part.name for part in at_creation} == {"size"}
    assert [constant.name for constant in main.constants] == ["inner.size"]
    assert not any(isinstance(part, ParameterValue) for part in parts(main.body))


def test_processes_written_by_hand_stay() -> None:
    network = flattened("""
process Hand python "hand.py:Hand" { in u : int @ 1 ms  out y : int }
process Body { in u : int @ 1 ms  out y : int  communication { hand : Hand  u -> hand.u  hand.y -> y }  composition { hand } }
process Main {
  in u : int @ 1 ms
  out y : int
  communication { var x : int  body : Body  u -> body.u  body.y -> y }
  composition { u ? x ; body }
}
""")
    main = programs.process(network, "Main")
    assert runs(main) == ["body.hand"]
    (hand,) = main.instances
    assert (hand.name, hand.class_name) == ("body.hand", "Hand")
    assert [connection.attachment for connection in hand.connections] == [PortEnd("u"), PortEnd("y")]


def test_each_scope_closes_its_own_ends() -> None:
    network = flattened("""
process Reader { in u : int @ 1 ms  communication { var x : int }  composition { u ? x } }
process Twice { in u : int @ 1 ms  communication { one : Reader  u -> one.u  var x : int }  composition { one ; u ? x } }
process Main { in u : int @ 1 ms  communication { r : Twice  u -> r.u  var x : int }  composition { r ; u ? x } }
""")
    main = programs.process(network, "Main")
    found = {part.instance: part.ends for part in parts(main.body) if isinstance(part, ProcessScope)}
    assert found == {"r": (PortEnd("u", end=1),), "r.one": (PortEnd("u", end=2),)}
    assert main.creation == (PortEnd("u"), PortEnd("u", end=1), PortEnd("u", end=2))


def test_compositions_get_no_deeper_than_those_of_a_text() -> None:
    levels, inside = DEEPEST_PROCESSES - 2, "if n == 0 then " * 4
    text = "".join(
        f"process P{level} {{ out y : int  communication {{ p : P{level + 1}  var n : int = 0  p.y -> y }}"
        f"  composition {{ {inside} p {'else skip ' * 4} }} }}\n"
        for level in range(levels)
    )
    network = flattened(text + f"process P{levels} {{ out y : int  composition {{ y ! 1 }} }}\n")
    deepest = max(len(path) for entry in network.classes for path in scopes_below(entry))
    assert MAX_DEPTH // 10 < deepest <= MAX_DEPTH // 4
    assert len(network.classes) < 10


def scopes_below(entry: object) -> list[list[str]]:
    assert isinstance(entry, ProcessClass)
    return [name.split(".") for name in scopes(entry)]
