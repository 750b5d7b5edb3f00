"""The report of a deadlock names the processes that are waited for, and is the same at all levels and in C."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.simulate.deadlock.levels import LEVELS, report

PROCESSES = """
process A { out c : int composition { c ! 1 ; c ! 2 } }
process R { in c : int communication { var v : int } composition { c ? v } }
process S { in c : int communication { var v : int } composition { mu c ? v } }
"""
HEAD = "deadlock at 0 s: nothing that a process waits for can happen any more"
WRITES = "  Main.a waits to write Main.a.c"
READS = "  Main.s waits to read Main.a.c (case.csp:4)"
NOBODY_WRITES = "no other process that still runs writes to it"
NOBODY_TAKES = "no other process that still runs can take the value"

ONE_HAS_ENDED = """
process Main { communication { a : A r : R s : S a.c -> broadcast -> r.c, s.c } composition { a || r || s } }
"""
SOME_HAVE_ENDED = """
process G { in c : int communication { s : S r : R c -> r.c c -> s.c } composition { s || r } }
process Main {
  communication { a : A s : S g : G r : R a.c -> broadcast -> r.c, g.c, s.c } composition { a || r || g || s }
}
"""
INTERRUPTED = """
process K { out e : int composition { wait 5 ms ; e ! 1 } }
process Q {
  in c : int in e : int communication { var v : int var z : int }
  composition { (mu c ? v) interrupt e ? z -> skip }
}
process W { out c : int composition { mu (c ! 1 ; wait 2 ms) } }
process Main {
  communication { a : W k : K q : Q s : S a.c -> broadcast -> q.c, s.c k.e -> q.e } composition { a || k || q || s }
}
"""
GUARDED = """
process B { out c : int composition { c ! 1 ; (c ! 2 -> skip) } }
process Main { communication { a : B r : R s : S a.c -> broadcast -> r.c, s.c } composition { a || r || s } }
"""
NEVER_BEGUN = """
const on : bool = false
process Main {
  communication { a : A r : R s : S a.c -> broadcast -> r.c, s.c } composition { a || (if on then r else skip) || s }
}
"""
WRITER_HAS_ENDED = """
process Main { communication { a : A r : S s : S a.c -> broadcast -> r.c, s.c } composition { a || r || s } }
"""
RING = """
process X { out c : int in back : int communication { var v : int } composition { c ! 1 ; c ! 2 ; back ? v } }
process Y { in c : int out back : int communication { var v : int } composition { c ? v ; back ! v ; c ? v } }
process Main {
  communication { a : X r : R s : Y a.c -> broadcast -> r.c, s.c s.back -> a.back } composition { a || r || s }
}
"""
READERS_OF_ANY = """
process Main { communication { w : R2 r : S s : T a : A1 a.c -> any -> r.c, s.c s.d -> w.c }
  composition { a || r || s || w } }
process A1 { out c : int composition { c ! 1 } }
process R2 { in c : int communication { var v : int } composition { c ? v ; c ? v } }
process T { in c : int out d : int communication { var v : int } composition { d ! 0 ; mu (c ? v ; d ! v) } }
"""
WRITERS_OF_ANY = """
process Main { communication { a : A b : A r : R a.c, b.c -> any -> r.c } composition { a || r || b } }
"""
LOCAL_ANY = """
process Main {
  communication { channel c : int any var v : int var w : int }
  composition { c ! 1 || (mu c ? v) || (mu c ? w) }
}
"""
READ_BY_PARTS = """
process Main {
  communication { channel c : int broadcast var a : int var b : int var d : int }
  composition { (c ! 1 ; c ! 2) || (c ? a ; c ? a) || c ? b || (c ? d ; c ? d) }
}
"""
READ_BY_PARTS_AND_OTHERS = """
process Main {
  communication { channel c : int broadcast var a : int var b : int r : R s : S c -> r.c c -> s.c }
  composition { (c ! 1 ; c ! 2) || (c ? a ; c ? a) || (c ? b ; c ? b) || r || s }
}
"""
READ_BY_A_LAW_TOO = """
submodel L { in c : int out y : int state n : int = 0 next n = n + c y = n }
process X { out c : int in back : int communication { var v : int } composition { c ! 1 ; c ! 2 ; back ? v } }
process Y { in c : int out back : int communication { var v : int } composition { c ? v ; back ! v ; c ? v } }
process T {
  in c : int
  communication { var v : int one : L two : L c -> one.c, two.c one.y -> _ two.y -> _ }
  composition { (c ? v ; one) ; mu two }
}
process Main {
  communication { t : T a : X s : Y a.c -> broadcast -> t.c, s.c s.back -> a.back } composition { t || a || s }
}
"""
RING_OF_ANY = """
process X { out c : int in back : int communication { var v : int } composition { c ! 1 ; back ? v ; c ! 2 } }
process Y { in c : int out back : int communication { var v : int } composition { mu (c ? v ; c ? v ; back ! v) } }
process Main { communication { x : X y : Y z : Y x.c -> any -> y.c, z.c  y.back, z.back -> any -> x.back }
  composition { x || y || z } }
"""


@pytest.mark.parametrize("arguments", LEVELS, ids=" ".join)
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ONE_HAS_ENDED, [HEAD, f"{WRITES} (case.csp:2), for Main.r, which has ended", READS]),
        (
            SOME_HAVE_ENDED,
            [
                HEAD,
                f"{WRITES} (case.csp:2), for Main.g.r, Main.r, which have ended",
                READS.replace(".s", ".g.s"),
                READS,
            ],
        ),
        (
            INTERRUPTED,
            [HEAD.replace("0 s", "6 ms"), f"{WRITES} (case.csp:11), for Main.q, which has ended", READS],
        ),
        (GUARDED, [HEAD, f"{WRITES} (case.csp:6), for Main.r, which has ended", READS]),
        (NEVER_BEGUN, [HEAD, f"{WRITES} (case.csp:2); {NOBODY_TAKES}", READS]),
        (
            WRITER_HAS_ENDED,
            [
                HEAD,
                *(f"{line}; {NOBODY_WRITES}" for line in (READS.replace(".s", ".r"), READS)),
            ],
        ),
        (
            RING,
            [
                "deadlock at 0 s: 2 processes wait for each other",
                f"{WRITES} (case.csp:6), for Main.s and for Main.r, which has ended",
                "  Main.s waits to write Main.s.back (case.csp:7), for Main.a",
            ],
        ),
        (
            READERS_OF_ANY,
            [
                HEAD,
                f"  Main.r waits to read Main.a.c (case.csp:4); {NOBODY_WRITES}",
                f"  Main.s waits to read Main.a.c (case.csp:10); {NOBODY_WRITES}",
                "  Main.w waits to read Main.s.d (case.csp:9)",
            ],
        ),
        (
            WRITERS_OF_ANY,
            [
                HEAD,
                f"{WRITES} (case.csp:2); {NOBODY_TAKES}",
                f"  Main.b waits to write Main.a.c (case.csp:2); {NOBODY_TAKES}",
            ],
        ),
        (LOCAL_ANY, [HEAD, *[f"  Main waits to read Main.c (case.csp:8); {NOBODY_WRITES}"] * 2]),
        (
            READ_BY_PARTS,
            [HEAD, f"  Main waits to write Main.c (case.csp:8); {NOBODY_TAKES}"],
        ),
        (
            READ_BY_PARTS_AND_OTHERS,
            [
                HEAD,
                "  Main waits to write Main.c (case.csp:8), for Main.r, which has ended",
                "  Main.s waits to read Main.c (case.csp:4)",
            ],
        ),
        (
            READ_BY_A_LAW_TOO,
            [
                "deadlock at 0 s: 2 processes wait for each other",
                "  Main.a waits to write Main.a.c (case.csp:7), for Main.s",
                "  Main.s waits to write Main.s.back (case.csp:8), for Main.a",
                "besides:",
                "  Main.t.two waits to read Main.a.c (case.csp:6)",
            ],
        ),
        (
            RING_OF_ANY,
            [
                "deadlock at 0 s: 2 processes wait for each other",
                "  Main.x waits to read Main.y.back (case.csp:6), for Main.y",
                "  Main.y waits to read Main.x.c (case.csp:7), for Main.x",
                "besides:",
                "  Main.z waits to read Main.x.c (case.csp:7)",
            ],
        ),
    ],
    ids=[
        "one",
        "some",
        "interrupted",
        "guarded",
        "never begun",
        "writer",
        "ring",
        "readers of any",
        "writers of any",
        "local any",
        "read by parts",
        "read by parts and others",
        "read by a law, too",
        "ring of any",
    ],
)
def test_a_report_names_the_missing_processes(
    text: str, expected: list[str], arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert report(f"{PROCESSES}{text}", arguments, tmp_path, capsys) == expected
