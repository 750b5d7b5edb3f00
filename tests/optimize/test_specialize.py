"""Classes are cloned by what their ports are connected to, and contain what targets need to know."""

from __future__ import annotations

import pytest

from cspdiag.network.ir.actions import ChannelEnd, Choice, PortEnd, ReadValue, WaitStep, WriteValue
from cspdiag.network.ir.network import CreatedChoice, CreatedInstance, Medium, Network, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize import lower_for_targets
from tests.network import programs

SINK = """
process Sink { in input : int = 3  communication { var x : int }  composition { mu (input ? x ; wait 1 ms) } }
"""

SOURCE = """
process Source { out output : int  composition { mu (output ! 1 ; wait 1 ms) } }
"""


def lowered(text: str) -> Network:
    return lower_for_targets(programs.network(text))


def media(network: Network, name: str) -> dict[str, tuple[Medium, ...]]:
    return {port.name: port.media for port in programs.process(network, name).ports}


def names(network: Network) -> list[str]:
    return [entry.name for entry in network.classes if isinstance(entry, ProcessClass)]


def instances(network: Network) -> dict[str, str]:
    return {instance.path: instance.class_name for instance in network.instances}


KINDS = (
    SINK
    + SOURCE
    + """
process Main {
  in sampled : int @ 1 ms
  in event : int
  communication {
    a : Sink
    b : Sink
    c : Sink
    d : Sink
    e : Sink
    sampled -> a.input
    event -> b.input
    f : Source
    g : Source
    f.output -> buffer 2 -> d.input
    g.output -> e.input
  }
  composition { a || b || c || d || e || f || g }
}
"""
)


def test_a_class_for_each_kind_of_connection() -> None:
    network = lowered(KINDS)
    found = {
        path: media(network, name)["input"] for path, name in instances(network).items() if path[5:] in list("abcde")
    }
    assert found == {
        "Main.a": (Medium("sampled"),),
        "Main.b": (Medium("event"),),
        "Main.c": (Medium("constant"),),
        "Main.d": (Medium("buffer"),),
        "Main.e": (Medium("sync"),),
    }
    assert sorted(names(network)) == ["Main", "Sink", "Sink2", "Sink3", "Sink4", "Sink5", "Source", "Source2"]
    assert names(network)[-1] == "Main"


def test_equal_connections_share_a_class() -> None:
    network = lowered(
        SINK
        + SOURCE
        + """
process Main {
  communication { p[4] : Sink  q[4] : Source  for i < 4 { q[i].output -> p[i].input } }
  composition { (par i < 4 : p[i]) || (par i < 4 : q[i]) }
}
"""
    )
    assert names(network) == ["Sink", "Source", "Main"]


def test_guards_are_seen_from_both_sides() -> None:
    """The alternative is two processes below the owner of the channel, its writer is next to it."""
    network = lowered(
        SOURCE
        + """
process Chooser { in a : int  in b : int  communication { var x : int }  composition { mu ((a ? x -> skip) [] (b ? x -> skip)) } }
process Inner { in a : int  in b : int  communication { c : Chooser  a -> c.a  b -> c.b }  composition { c } }
process Main {
  communication { i : Inner  s : Source  t : Source  s.output -> i.a  t.output -> plain : int -> i.b }
  composition { i || s || t }
}
"""
    )
    assert media(network, "Source") == {"output": (Medium("sync", guarded_reads=True),)}
    channels = programs.process(network, "Main").channels
    assert [(channel.guarded_reads, channel.guarded_writes) for channel in channels] == [(True, False)] * 2


def test_outputs_to_the_environment() -> None:
    network = lowered("""
process Main {
  out latched : int @ 1 ms
  out direct : int
  out discarded : int @ 1 ms immediate
  composition { mu (latched ! 1 ; direct ! 2 ; discarded ! 3 ; wait 1 ms) }
}
""")
    found = media(network, "Main")
    assert found == {"latched": (Medium("latched"),), "direct": (Medium("direct"),), "discarded": (Medium("direct"),)}


ORDER = (
    SOURCE
    + """
submodel Law { in u : int  out y : int  y = u }
process Leaf { in input : int  communication { var x : int }  composition { mu input ? x } }
process Main {
  in a : int @ 1 ms
  in b : int @ 1 ms
  in c : int
  communication {
    var x : int = 0
    var y : int
    leaf : Leaf
    law : Law
    b -> law.u
    law.y -> _
    source : Source
    source.output -> leaf.input
  }
  composition {
    (mu (((when x < 3 & c ? x -> skip) [] (after 2 ms -> ((c ? x -> skip) [] (skip -> skip)))) ; law))
    || leaf || source || (mu a ? y)
  }
}
"""
)


def test_creation_is_in_the_order_of_ends_instances_and_alternatives() -> None:
    network = lowered(ORDER)
    assert programs.process(network, "Main").creation == (
        PortEnd("c"),
        PortEnd("a"),
        PortEnd("b"),
        CreatedInstance("leaf"),
        CreatedInstance("law"),
        CreatedInstance("source"),
        CreatedChoice("choice"),
        CreatedChoice("choice_2"),
    )


def test_ends_of_broadcasts_come_after_those_of_ports() -> None:
    network = lowered("""
process Main {
  in input : int
  communication { var x : int  var y : int  var z : int  channel k : int broadcast }
  composition { (mu (k ! 1 ; wait 1 ms)) || (mu k ? x) || (mu k ? y) || (mu input ? z) }
}
""")
    assert programs.process(network, "Main").creation == (PortEnd("input"), ChannelEnd("k"), ChannelEnd("k", 1))


@pytest.mark.parametrize(("guarded", "step"), [("c ? x", ReadValue), ("d ! x", WriteValue), ("after 1 ms", WaitStep)])
def test_a_guard_alone_is_a_step(guarded: str, step: type) -> None:
    network = lowered(f"""
process Main {{
  in c : int
  out d : int
  communication {{ var x : int = 0 }}
  composition {{ mu ({guarded} -> x := x + 1) until x > 3 }}
}}
""")
    found = list(parts(programs.process(network, "Main").body))
    assert any(isinstance(part, step) for part in found)
    assert not any(isinstance(part, Choice) for part in found)
