"""The columns of tables: branches without names are in the order of the text, and the key says where they begin. There
are no columns for very many processes.
"""

from __future__ import annotations

from cspdiag.proofs.counterexamples.table import table
from tests.support.verifying import answer_to

BRANCHES = """process Top {
  communication {
    channel c : int any
    channel d : int
    var x : int = 0
    var y : int = 0
  }
  composition {
    ( (d ? x ; stop)
    || (par k < 2 : (wait 1 ms ; c ! k))
    || (c ? y ; c ? y ; d ! 1) )
  }
}
assert Top deadlock free
"""
TWICE = """process Part {
  communication { channel c : int sync var x : int = 0 }
  composition {
    ((wait 2 ms ; wait 1 ms) || (wait 1 ms ; wait 4 ms)) ;
    ((c ? x ; stop) || (wait 1 ms ; c ! 1))
  }
}
process Main {
  communication { part : Part other : Part }
  composition { part || other }
}
assert Main deadlock free
"""


def _table(text: str) -> list[str]:
    answer = answer_to(text)
    assert answer.counterexample is not None
    return table(answer.counterexample).splitlines()


def test_branches_are_in_the_order_of_the_text_with_their_lines() -> None:
    lines = _table(BRANCHES)
    assert lines[0].split() == ["1", "2", "3", "4"]
    assert lines[-1] == "1: branch in line 9  2, 3: branches in line 10  4: branch in line 11"
    assert "*10" in lines[1], "branch 1 takes part last"


def test_branches_of_several_parallels_and_instances() -> None:
    lines = _table(TWICE)
    names = lines[0].split("  ")
    first = [name for name in map(str.strip, names) if name.startswith("part.")]
    assert first == ["part.1", "part.2", "part.1 (2)", "part.2 (2)"]
    key = " ".join(line.strip() for line in lines if "branch" in line)
    assert "part.1" in key
    assert "part.2 (2)" in key
    assert "in line 4" in key
    assert "in line 5" in key


def test_a_key_without_branches_has_no_line_for_them() -> None:
    named = """process Writer { out c : int composition { c ! 1 } }
process Reader { in c : int communication { var x : int } composition { c ? x ; c ? x } }
process Main { communication { w : Writer r : Reader w.c -> r.c } composition { w || r } }
assert Main deadlock free
"""
    assert not any("branch" in line for line in _table(named))


def ring(cells: int) -> str:
    return f"""process Cell {{
  in input : int
  out output : int
  communication {{ var x : int }}
  composition {{ mu (input ? x ; output ! x) }}
}}
process First {{
  in input : int
  out output : int
  communication {{ var x : int = 7 }}
  composition {{ mu (output ! x ; input ? x) }}
}}
process Main {{
  communication {{
    first : First
    cell[{cells}] : Cell
    first.output -> cell[0].input
    for i < {cells - 1} {{ cell[i].output -> cell[i + 1].input }}
    cell[{cells - 1}].output -> first.input
  }}
  composition {{ first || par i < {cells} : cell[i] }}
}}
assert Main livelock free
"""


def test_with_very_many_processes_each_row_names_those_who_take_part() -> None:
    assert "(1)" in _table(ring(19))[0]
    lines = _table(ring(20))
    assert lines[0].split() == ["who", "takes", "part"]
    assert lines[2].split("  ")[-1].strip() == "first !11, cell[0] ?5"
    assert lines[-2].split("  ")[-1].strip() == "cell[19] !5, first ?11"


def test_a_table_grows_as_the_processes_do() -> None:
    small, large = (len("".join(_table(ring(cells)))) for cells in (100, 200))
    assert large < 2.2 * small
