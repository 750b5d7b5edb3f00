"""The report of a deadlock between parallel parts of one process is true, and the same at all levels and in C."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.simulate.deadlock.levels import LEVELS, report

CHANNELS = "channel a : int channel b : int channel c : int channel d : int"
VARIABLES = "var x : int var y : int var z : int var w : int"
CASES = {
    "two parts": """
process Main {
  communication { channel a : int channel b : int var x : int var y : int }
  composition { (a ! 1 ; b ? x) || (b ! 2 ; a ? y) }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:4), for another part of it
#   Main waits to write Main.b (case.csp:4), for another part of it
""",
    "three parts": """
process Main {
  communication { channel a : int channel b : int channel c : int var x : int var y : int var z : int }
  composition {
    (a ! 1 ; b ? x) ||
    (b ! 2 ; c ? y) ||
    (c ! 1 ; a ? z)
  }
}
# deadlock at 0 s: 3 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:5), for another part of it
#   Main waits to write Main.c (case.csp:7), for another part of it
#   Main waits to write Main.b (case.csp:6), for another part of it
""",
    "parts of two processes": """
process A {
  in i : int out o : int
  communication { var v : int var w : int channel a : int }
  composition { (o ! 1 ; a ? v) || (a ! 1 ; i ? w) }
}
process Main { communication { p : A q : A p.o -> q.i q.o -> p.i } composition { p || q } }
# deadlock at 0 s: 4 parts of 2 processes wait for each other
#   Main.p waits to write Main.p.o (case.csp:5), for Main.q
#   Main.q waits to write Main.q.a (case.csp:5), for another part of it
#   Main.q waits to write Main.q.o (case.csp:5), for Main.p
#   Main.p waits to write Main.p.a (case.csp:5), for another part of it
""",
    "a process between parts": """
process W { out o : int in i : int communication { var v : int } composition { i ? v ; o ! v } }
process Main {
  communication { channel a : int channel b : int channel c : int var x : int w : W w.o -> a b -> w.i }
  composition { (a ? x ; c ? x) || (c ! 1 ; b ! 1) || w }
}
# deadlock at 0 s: 3 parts of 2 processes wait for each other
#   Main waits to read Main.a (case.csp:5), for Main.w
#   Main.w waits to read Main.b (case.csp:2), for Main
#   Main waits to write Main.c (case.csp:5), for another part of it
""",
    "rows alike": """
process Main {
  communication { channel a : int any channel b : int any var x : int var y : int var z : int }
  composition { (a ! 1 ; b ? x) || (b ! 2 ; a ? y) || (a ! 1 ; b ? z) || b ! 5 || b ! 6 }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:4), for another part of it
#   Main waits to write Main.b (case.csp:4), for another part of it
# besides:
#   Main waits to write Main.a (case.csp:4)
#   Main waits to write Main.b (case.csp:4)
#   Main waits to write Main.b (case.csp:4)
""",
    "a buffer": """
process Main {
  communication { channel a : int buffer(1) channel b : int var x : int var y : int }
  composition { (a ! 1 ; a ! 1 ; b ? x) || (b ! 2 ; a ? y ; a ? y) }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:4), for another part of it
#   Main waits to write Main.b (case.csp:4), for another part of it
""",
    "a broadcast": """
process R { in c : int in d : int communication { var v : int } composition { d ? v ; c ? v } }
process Main {
  communication { channel c : int broadcast channel d : int var x : int var y : int r : R c -> r.c d -> r.d }
  composition { (c ! 1 ; d ! 1) || (c ? x ; c ? x) || (c ? y ; c ? y) || r }
}
# deadlock at 0 s: 2 processes wait for each other
#   Main waits to write Main.c (case.csp:5), for Main.r
#   Main.r waits to read Main.d (case.csp:2), for Main
# besides:
#   Main waits to read Main.c (case.csp:5)
#   Main waits to read Main.c (case.csp:5)
""",
    "alternatives": f"""
process Main {{
  communication {{ {CHANNELS} {VARIABLES} }}
  composition {{ (a ! 1 -> c ? x [] b ! 1 -> d ? x) || (c ! 2 -> a ? y [] d ! 2 -> b ? y) }}
}}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a or to write Main.b (case.csp:4), for another part of it
#   Main waits to write Main.c or to write Main.d (case.csp:4), for another part of it
""",
    "an interrupt": """
process Main {
  communication { channel a : int channel b : int channel c : int var x : int var y : int }
  composition {
    ((a ! 1
        interrupt c ? x -> skip) ; b ? x)
    || (b ! 2 ; a ? y ; c ! 3)
  }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:5), for another part of it
#   Main waits to write Main.b (case.csp:7), for another part of it
""",
    "the guard of an interrupt": """
process Main {
  communication { channel c : int any var x : int }
  composition {
    (stop interrupt c ! 1 -> skip) ||
    (wait 1 ms ;
       (stop
          interrupt c ! 2 -> skip)) ||
    (wait 2 ms ; c ? x)
  }
}
# deadlock at 2 ms: nothing that a process waits for can happen any more
#   Main waits to write Main.c (case.csp:7); no other process that still runs can take the value
""",
    "a handler": """
exception Jammed
process Main {
  communication { channel a : int channel b : int var x : int var y : int }
  composition { ((a ! 1 ; raise Jammed) catch Jammed -> b ? x) || (b ! 2 ; a ? y) }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:5), for another part of it
#   Main waits to write Main.b (case.csp:5), for another part of it
""",
    "nested parallel parts": f"""
process Main {{
  communication {{ {CHANNELS} {VARIABLES} }}
  composition {{
    ((a ! 1 || c ? z) ; b ? x ; d ! 1) ||
    (b ! 2 ; a ? y ; (c ! 1 || d ? w))
  }}
}}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.a (case.csp:5), for another part of it
#   Main waits to write Main.b (case.csp:6), for another part of it
# besides:
#   Main waits to read Main.c (case.csp:5)
""",
    "after parallel parts that do not end": """
process Main {
  communication { channel a : int channel b : int var x : int var y : int }
  composition { ((a ! 1 || stop) ; b ? x) || (b ! 2 ; a ? y) }
}
# deadlock at 0 s: nothing that a process waits for can happen any more
#   Main waits to write Main.a (case.csp:4)
#   Main waits forever, at stop (case.csp:4)
#   Main waits to write Main.b (case.csp:4); no other process that still runs can take the value
""",
    "parts on several lines": """
process Main {
  communication { channel a : int channel c : int any var x : int var y : int }
  composition {
    a ! 1
    || (c ! 1 ||
        c ! 2)
    || (stop ; (a ? x || c ? y))
    || stop
  }
}
# deadlock at 0 s: nothing that a process waits for can happen any more
#   Main waits to write Main.a (case.csp:5); no other process that still runs can take the value
#   Main waits to write Main.c (case.csp:6); no other process that still runs can take the value
#   Main waits to write Main.c (case.csp:7); no other process that still runs can take the value
#   Main waits forever, at stop (case.csp:8)
#   Main waits forever, at stop (case.csp:9)
""",
    "a partner that has passed": """
process P { in b : int out a : int communication { var x : int } composition { b ? x ; b ? x ; a ! 1 } }
process Q { out b : int in a : int communication { var x : int } composition { b ! 1 ; a ? x } }
process Main { communication { p : P q : Q q.b -> p.b p.a -> q.a } composition { p || q } }
# deadlock at 0 s: nothing that a process waits for can happen any more
#   Main.p waits to read Main.q.b (case.csp:2); no other process that still runs writes to it
#   Main.q waits to read Main.p.a (case.csp:3)
""",
    "a partner that begins later": """
process W { out o : int composition { o ! 1 } }
process R { in i : int communication { var v : int } composition { i ? v } }
process Inner { out o : int in i : int communication { w : W r : R w.o -> o i -> r.i } composition { w ; r } }
process Main { communication { one : Inner two : Inner one.o -> two.i two.o -> one.i } composition { one || two } }
# deadlock at 0 s: 2 processes wait for each other
#   Main.one.w waits to write Main.one.o (case.csp:2), for Main.two.w
#   Main.two.w waits to write Main.two.o (case.csp:2), for Main.one.w
""",
    "a control law": """
submodel L { in u : int out y : int  y = u + 1 }
process Main {
  communication { l : L channel a : int channel b : int var x : int a -> l.u l.y -> b }
  composition { (mu l) || (a ! 1 ; a ! 2 ; b ? x) }
}
# deadlock at 0 s: 2 processes wait for each other
#   Main.l waits to write Main.b (case.csp:2), for Main
#   Main waits to write Main.a (case.csp:5), for Main.l
""",
    "a control law that has not run": """
submodel L { in u : int out y : int  y = u + 1 }
process Main {
  communication {
    channel c : int broadcast channel b : int var x : int var y : int l : L c -> l.u l.y -> _
  }
  composition { (c ! 1 ; b ! 1) || c ? x || (b ? y ; l) }
}
# deadlock at 0 s: 2 parallel parts of Main wait for each other
#   Main waits to write Main.c (case.csp:7), for another part of it
#   Main waits to read Main.b (case.csp:7), for another part of it
""",
}


@pytest.mark.parametrize("arguments", LEVELS, ids=" ".join)
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_parallel_parts_wait_for_each_other(
    case: str, arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, _, expected = case.partition("# ")
    assert report(text, arguments, tmp_path, capsys) == f"# {expected}".replace("# ", "").splitlines()
