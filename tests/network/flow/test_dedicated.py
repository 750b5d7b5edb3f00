"""Channels of which each end belongs to one task."""

from __future__ import annotations

import pytest

from cspdiag.network.flow.dedicated import Place, dedicated_places
from cspdiag.optimize import lower_for_targets
from tests.network import programs

SOURCE_TO_READER: frozenset[Place] = frozenset(
    {("Source", "o", None), ("Main", "source.o", None), ("Reader", "i", None)}
)


def dedicated(text: str) -> frozenset[Place]:
    return dedicated_places(lower_for_targets(programs.network(text)))


def reading(composition: str, parts: str = "") -> frozenset[Place]:
    """In a program in which a process with this composition, or parts of it, read from ``i``, without what belongs to
    its other input.
    """
    found = dedicated(f"""
process Source {{ out o : int  composition {{ mu o ! 1 }} }}
process Other {{ out o : int  composition {{ mu o ! 1 }} }}
process Part {{ in i : int  communication {{ var x : int }}  composition {{ i ? x }} }}
process Reader {{
  in i, j : int
  communication {{ {parts} var x : int  var y : int }}
  composition {{ {composition} }}
}}
process Main {{
  communication {{ source : Source  other : Other  reader : Reader  source.o -> reader.i  other.o -> reader.j }}
  composition {{ source || other || reader }}
}}
""")
    return found - {("Other", "o", None), ("Main", "other.o", None), ("Reader", "j", None)}


@pytest.mark.parametrize(
    "composition",
    [
        "i ? x ; j ? y ; i ? x",
        "mu (i ? x || j ? y)",
        "(i ? x ; i ? x) || j ? y",
        "mu ((mu i ? x) interrupt j ? y -> skip)",
        "mu (i ? x interrupt after 1 ms -> j ? y)",
    ],
)
def test_a_channel_belongs_to_the_task_that_reads_and_the_task_that_writes(composition: str) -> None:
    assert reading(composition) >= SOURCE_TO_READER


@pytest.mark.parametrize(
    "composition",
    [
        "(i ? x || j ? y) ; i ? x",
        "i ? x ; (mu (i ? x || j ? y))",
        "(i ? x || j ? y) ; (j ? y || i ? x)",
        "(mu i ? x) interrupt j ? y -> i ? x",
        "i ? x -> skip [] j ? y -> skip",
        "(mu j ? x) interrupt i ? y -> skip",
    ],
)
def test_a_channel_that_several_tasks_or_a_guard_use_at_one_end_belongs_to_none(composition: str) -> None:
    assert not reading(composition) & SOURCE_TO_READER


def test_instances_in_sequence_are_several_tasks() -> None:
    one, two = "part : Part  i -> part.i", "part : Part  second : Part  i -> part.i  i -> second.i"
    assert reading("part ; j ? y", one) >= SOURCE_TO_READER | {("Part", "i", None)}
    assert not reading("part ; second ; j ? y", two)
    assert not reading("part ; i ? x ; j ? y", one)


def test_a_class_is_written_for_all_channels_that_its_instances_have() -> None:
    """One of the two channels has two readers in sequence: no code for both can rely on its reader."""
    program = """
process Source { out o : int  composition { mu o ! 1 } }
process Plain { in i : int  communication { var x : int }  composition { mu i ? x } }
process Twice { in i : int  communication { var x : int  var y : int }  composition { (i ? x || wait 1 ms) ; i ? y } }
process Main {
  communication { a : Source  b : Source  p : Plain  q : %s  a.o -> p.i  b.o -> q.i }
  composition { a || b || p || q }
}
"""
    assert ("Main", "a.o", None) in dedicated(program % "Plain")
    assert not dedicated(program % "Twice")


def test_elements_of_arrays_belong_to_one_task_each() -> None:
    found = dedicated("""
process Cell { in i : int  out o : int  communication { var x : int = 0 }  composition { mu (o ! x ; i ? x) } }
process Main {
  communication { c[i < 3] : Cell  for i < 3 { c[i].o -> c[(i + 1) % 3].i } }
  composition { par i < 3 : c[i] }
}
""")
    assert found == {("Cell", "i", None), ("Cell", "o", None), *(("Main", f"c[{i}].o", None) for i in range(3))}


def test_a_program_with_a_law_in_python_has_none() -> None:
    """What that returns need not be a value."""
    text = """
submodel Law %s
process Run { in i : int  out o : int  communication { law : Law  i -> law.u  law.y -> o }  composition { mu law } }
process Source { out o : int  composition { mu o ! 1 } }
process Sink { in i : int  communication { var x : int }  composition { mu i ? x } }
process Main {
  communication { source : Source  run : Run  sink : Sink  source.o -> run.i  run.o -> sink.i }
  composition { source || run || sink }
}
"""
    ports = "in u : int  out y : int"
    assert not dedicated(text % f'python "law.py:Law" {{ {ports} }}')
    assert not dedicated(text % f"{{ {ports}  y = u }}"), "a law that is not inlined reads by itself"
