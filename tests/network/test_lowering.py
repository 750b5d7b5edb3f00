"""Classes, arguments and instances of networks."""

from __future__ import annotations

import pytest

from cspdiag.network.analyse import DEEPEST_PROCESSES
from cspdiag.network.dump.network import dump
from cspdiag.network.ir.expressions import FunctionCall, LiteralValue, ParameterValue
from cspdiag.network.lower.program import SelectionError
from tests.network.programs import network, process

FILTER = """
submodel Filter {
  in  raw    : double
  out smooth : double
  state last : double = 0
  smooth    = last
  next last = last + sample / 1 s * (raw - last)
}
"""


def _sample(text: str, cls: str, instance: str) -> object:
    found = process(network(text), cls)
    arguments = {i.name: dict(i.arguments) for i in found.instances}
    return arguments[instance]["sample"]


def test_a_sample_period_is_passed_on_through_the_period_of_a_port() -> None:
    text = (
        FILTER
        + """
process Shell(patience: time, T: time) {
  in  raw    : double @ T
  out smooth : double @ T
  communication {
    filter : Filter
    raw           -> filter.raw
    filter.smooth -> smooth
  }
  composition { (mu filter) interrupt after patience -> skip }
}
process Main {
  in  raw    : double @ 1 ms
  out smooth : double @ 1 ms
  communication {
    shell : Shell(1 ms, 1 ms)
    raw          -> shell.raw
    shell.smooth -> smooth
  }
  composition { shell }
}
"""
    )
    value = _sample(text, "Shell", "filter")
    assert isinstance(value, FunctionCall)
    assert value.function == "seconds"
    assert value.arguments[0] == ParameterValue(type=value.arguments[0].type, name="T")


def test_a_sample_period_that_all_instances_share_is_a_literal() -> None:
    text = (
        FILTER
        + """
process Shell {
  in  raw    : double
  out smooth : double
  communication {
    filter : Filter
    raw           -> filter.raw
    filter.smooth -> smooth
  }
  composition { mu filter }
}
process Main {
  in  a, b : double @ 2 ms
  out c, d : double @ 2 ms
  communication {
    one   : Shell
    other : Shell
    a -> one.raw
    b -> other.raw
    one.smooth   -> c
    other.smooth -> d
  }
  composition { one || other }
}
"""
    )
    value = _sample(text, "Shell", "filter")
    assert isinstance(value, LiteralValue)
    assert value.value == 0.002


def test_different_periods_are_lifted_as_far_as_needed() -> None:
    """The shell inside the case has no parameter for the period, nor has the case; the outermost process knows it."""
    text = (
        FILTER
        + """
process Shell {
  in  raw    : double
  out smooth : double
  communication {
    filter : Filter
    raw           -> filter.raw
    filter.smooth -> smooth
  }
  composition { mu filter }
}
process Case {
  in  raw    : double
  out smooth : double
  communication {
    shell : Shell
    raw          -> shell.raw
    shell.smooth -> smooth
  }
  composition { shell }
}
process Main {
  in  a : double @ 1 ms
  in  b : double @ 2 ms
  out c : double @ 1 ms
  out d : double @ 2 ms
  communication {
    one   : Case
    other : Case
    a -> one.raw
    b -> other.raw
    one.smooth   -> c
    other.smooth -> d
  }
  composition { one || other }
}
"""
    )
    found = network(text)
    assert [entry.name for entry in found.classes] == ["Filter", "Shell", "Case", "Main"]
    assert [p.name for p in found.class_named("Case").parameters if p.derived] == ["shell_filter_sample"]
    values = [dict(instance.arguments)["shell_filter_sample"] for instance in process(found, "Main").instances]
    assert [value.value for value in values if isinstance(value, LiteralValue)] == [0.001, 0.002]
    by_path = {instance.path: dict(instance.arguments) for instance in found.instances}
    assert by_path["Main.other.shell.filter"] == {"sample": 0.002}


def test_instances_that_differ_in_values_only_share_a_class() -> None:
    text = """
process Cell(id: int) { out y : int  composition { y ! id } }
process Row(n: int) {
  out y[n] : int
  communication {
    cell[i < n] : Cell(id = i * n)
    for i < n { cell[i].y -> y[i] }
  }
  composition { par i < n : cell[i] }
}
process Main {
  out a[2] : int
  out b[3] : int
  out c[3] : int
  communication {
    short : Row(2)
    long  : Row(3)
    again : Row(3)
    short.y -> a
    long.y  -> b
    again.y -> c
  }
  composition { short || long || again }
}
"""
    found = network(text)
    assert [entry.name for entry in found.classes] == ["Cell", "Row", "Row_2", "Main"]
    assert [i.class_name for i in process(found, "Main").instances] == ["Row", "Row_2", "Row_2"]
    paths = [i.path for i in found.instances]
    assert paths[:4] == ["Main", "Main.short", "Main.short.cell[0]", "Main.short.cell[1]"]


OVERRIDDEN = """
process Cell(id: int, step: int = id + 1) { out y : int  composition { seq i < 2 : y ! id + step } }
process Pair(id: int) {
  out y : int
  communication {
    left  : Cell(id)
    right : Cell(id)
    left.y, right.y -> y
  }
  composition { left ; right }
}
process Main {
  out a, b : int
  communication {
    one   : Pair(1)
    other : Pair(2)
    one.y   -> a
    other.y -> b
  }
  composition { one || other }
}
"""


def test_an_override_concerns_one_instance_only() -> None:
    found = network(OVERRIDDEN, {"other.left.id": 7})
    values = {i.path: dict(i.arguments) for i in found.instances if i.class_name == "Cell"}
    assert values == {
        "Main.one.left": {"id": 1, "step": 2},
        "Main.one.right": {"id": 1, "step": 2},
        "Main.other.left": {"id": 7, "step": 8},
        "Main.other.right": {"id": 2, "step": 3},
    }
    assert [i.class_name for i in process(found, "Main").instances] == ["Pair", "Pair_2"]


def test_arguments_are_expressions_over_the_parameters_of_the_enclosing_class() -> None:
    arguments = dict(process(network(OVERRIDDEN), "Pair").instances[0].arguments)
    assert arguments["id"] == ParameterValue(type=arguments["id"].type, name="id")
    assert "id + 1" in dump(network(OVERRIDDEN))


def test_the_same_program_gives_the_same_text() -> None:
    assert dump(network(OVERRIDDEN)) == dump(network(OVERRIDDEN))


def test_the_outermost_process_is_that_of_the_environment_or_the_last() -> None:
    text = """
process First { out y : int  composition { y ! 1 } }
process Last(n: int = 3) { out y : int  composition { y ! n } }
"""
    assert network(text).top == "Last"
    assert network(text, top="First").top == "First"
    assert network(text, {"n": 5}).arguments == (("n", 5),)


def test_there_may_be_nothing_to_compile() -> None:
    with pytest.raises(SelectionError, match="has no process"):
        network("const n = 1")
    with pytest.raises(SelectionError, match="no process `Missing`"):
        network("process Main { out y : int  composition { y ! 1 } }", top="Missing")
    with pytest.raises(SelectionError, match="no value for its parameter `n`"):
        network("process Main(n: int) { out y : int  composition { y ! n } }")


def test_the_deepest_hierarchy_is_followed() -> None:
    text = "process P0 { in a : int  communication { var v : int }  composition { a ? v } }\n"
    for level in range(1, DEEPEST_PROCESSES):
        text += (
            f"process P{level} {{ in a : int  communication {{ x : P{level - 1}  a -> x.a }}"
            "  composition { mu (a -> x) } }\n"
        )
    assert len(network(text).instances) == DEEPEST_PROCESSES


def test_a_capacity_requested_inside_an_instance_is_that_of_the_channel_outside() -> None:
    text = """
process Sink { in x : int  communication { var v : int }  composition { mu x ? v } }
process Shell(n: int) {
  in x : int
  communication {
    sink : Sink
    x -> buffer n + 1 -> sink.x
  }
  composition { sink }
}
process Source { out x : int  composition { mu x ! 1 } }
process Main {
  communication {
    source : Source
    shell  : Shell(3)
    source.x -> values : int -> shell.x
  }
  composition { source || shell }
}
"""
    (channel,) = process(network(text), "Main").channels
    assert (channel.name, channel.kind, channel.capacity) == ("values", "buffer", 4)
