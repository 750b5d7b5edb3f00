"""Lenses for commands that an editor has, the steps of a counterexample as diagrams show them, and the process that
finds them.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from lsprotocol import types

from cspdiag.base.span import SourceFile, Span
from cspdiag.lsp.features.lenses import PLOT, RUN, STEP, commands_of, lenses
from cspdiag.lsp.proving import prove, title_of
from cspdiag.lsp.session import Session
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.question import Question

CROSSED = """process Left { out a : int in b : int communication { var x : int } composition { a ! 1 ; b ? x } }
process Right { in a : int out b : int communication { var x : int } composition { a ? x ; b ! 2 ; a ? x } }
process Main {
  communication {
    left : Left
    right : Right
    left.a -> right.a
    right.b -> left.b
  }
  composition { left || right }
}
environment Bench for Main { }
assert Main deadlock free
"""


def titles(session: Session, uri: str, commands: frozenset[str]) -> list[str]:
    document = session.documents.get(uri)
    assert document is not None
    found = lenses(session.view(document), uri, session.positions, commands)
    return [f"{each.range.start.line + 1} {each.command.title}" for each in found if each.command is not None]


def test_an_editor_that_runs_programs_has_lenses_on_environments(tmp_path: Path) -> None:
    session, uri = Session(), (tmp_path / "crossed.csp").as_uri()
    session.documents.open(uri, CROSSED, 1)
    assert titles(session, uri, frozenset()) == ["13 Verify"]
    assert titles(session, uri, frozenset({RUN, PLOT, STEP})) == ["13 Verify", "12 Run", "12 Plot"]


@pytest.mark.parametrize("wrap", [lambda value: value, lambda value: SimpleNamespace(**value)])
def test_the_commands_of_an_editor_are_read_whatever_class_has_them(wrap: type) -> None:
    experimental = wrap({"cspdiag": wrap({"commands": [RUN]})})
    assert commands_of(types.ClientCapabilities(experimental=experimental)) == {RUN}
    assert commands_of(types.ClientCapabilities()) == frozenset()
    assert commands_of(types.ClientCapabilities(experimental=wrap({"cspdiag": 3}))) == frozenset()


STUCK_EARLY = """process Early { in go : int communication { var x : int } composition { go ? x ; wait 5 ms ; go ? x } }
process Left { out a : int in b : int communication { var x : int } composition { wait 9 ms ; a ! 1 ; b ? x } }
process Right {
  in a : int
  out b, go : int
  communication { var x : int }
  composition { go ! 1 ; a ? x ; b ! 2 ; a ? x }
}
process Main {
  communication {
    early : Early
    left : Left
    right : Right
    left.a -> right.a
    right.b -> left.b
    right.go -> early.go
  }
  composition { early || left || right }
}
assert Main deadlock free
"""


@pytest.mark.asyncio
async def test_a_process_that_waits_to_the_end_does_so_in_each_step_after_its_last(tmp_path: Path) -> None:
    session, uri = Session(), (tmp_path / "early.csp").as_uri()
    view = session.view(session.documents.open(uri, STUCK_EARLY, 1))
    (answer,) = await prove(view.main, {}, STUCK_EARLY.index("assert"))
    early = {"early", "right.go -> early.go", "early.go", "right.go", "step-1.1"}
    assert [(each["text"], set(each["waiting"])) for each in answer.steps] == [
        ("wait 9 ms of left", set()),
        ("right.go 1", set()),
        ("wait 5 ms of early", set()),
        ("left.a 1", early),
        ("right.b 2", early),
        (
            "early waits to read right.go; right waits to read left.a",
            early | {"right", "left.a -> right.a", "left.a", "right.a", "step-1.3"},
        ),
    ]


@pytest.mark.asyncio
async def test_the_steps_of_a_counterexample_have_the_keys_of_the_diagram(tmp_path: Path) -> None:
    session, uri = Session(), (tmp_path / "crossed.csp").as_uri()
    view = session.view(session.documents.open(uri, CROSSED, 1))
    (answer,) = await prove(view.main, {}, CROSSED.index("assert"))
    ports = {"left.a", "right.a", "right.b", "left.b"}
    steps = [
        (each["process"], each["text"], set(each["communicating"]) - ports, set(each["waiting"]) - ports)
        for each in answer.steps
    ]
    both = {"left", "right", "step-1.1", "step-1.2"}
    a, b = both | {"left.a -> right.a"}, both | {"right.b -> left.b"}
    assert steps == [
        ("Main", "left.a 1", a, set()),
        ("Main", "right.b 2", b, set()),
        ("Main", "right waits to read left.a", set(), {"right", "left.a -> right.a", "step-1.2"}),
    ]
    view.answers[answer.start] = answer
    assert titles(session, uri, frozenset({STEP}))[1:] == ["13 Step through"]


CELLS = """process Cell { in a : int out b : int communication { var x : int } composition { a ? x ; b ! x ; a ? x } }
process Main {
  communication {
    var y : int
    cell[2] : Cell
    channel go : int
    channel back : int
    go -> cell[1].a
    cell[1].b -> cell[0].a
    cell[0].b -> back
  }
  composition { cell[0] || cell[1] || (go ! 1 ; back ? y) }
}
assert Main deadlock free
"""


@pytest.mark.asyncio
async def test_a_step_is_in_the_composition_where_its_processes_are_run_and_where_the_process_itself_is(
    tmp_path: Path,
) -> None:
    session, uri = Session(), (tmp_path / "cells.csp").as_uri()
    view = session.view(session.documents.open(uri, CELLS, 1))
    (answer,) = await prove(view.main, {}, CELLS.index("assert"))

    def composed(keys: list[str]) -> set[str]:
        return {key for key in keys if key.startswith("step-")}

    steps = [(each["text"], composed(each["communicating"]), composed(each["waiting"])) for each in answer.steps]
    sender, receiver, first, second = "step-1.3.1", "step-1.3.2", "step-1.1", "step-1.2"
    assert steps == [
        ("go 1", {sender, second}, set()),
        ("cell[1].b 1", {second, first}, set()),
        ("back 1", {first, receiver}, {second}),
        ("cell[0] waits to read cell[1].b; cell[1] waits to read go", set(), {first, second}),
    ]


def test_a_lens_says_once_that_nothing_was_proved() -> None:
    question = Question("Big", "terminates", Span(SourceFile(name="big.csp", text="assert Big terminates"), 0, 21))
    answer = Answer(question, "unknown", None, "a limit was reached", 1.0)
    assert title_of(answer) == "Not proved: a limit was reached"


LONG = """\
process Main {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  communication {
    var v : double
    var n : int = 0
  }
  composition {
    mu (x ? v ; n := (n * 1103515245 + 12345) % 2147483648 ; if n == 7777777 then stop else y ! v)
  }
}
assert Main deadlock free
"""
"""Two thousand million states."""

SERVER = f"""
import asyncio, sys
from cspdiag.base.span import SourceFile
from cspdiag.lsp import proving

pipe = int(sys.argv[1])
# It says when it works, and keeps the pipe as long as it does.
proving._PROGRAM = proving._PROGRAM.replace("answer(request)", f"import os; os.write({{pipe}}, b'!'); answer(request)")
text = {LONG!r}

async def main():
    create = asyncio.create_subprocess_exec
    asyncio.create_subprocess_exec = lambda *command, **options: create(*command, pass_fds=[pipe], **options)
    await proving.prove(SourceFile(name="main.csp", text=text), {{}}, text.index("assert"))

asyncio.run(main())
"""


@pytest.mark.skipif(sys.platform == "win32", reason="passes a descriptor")
def test_the_prover_ends_when_the_server_is_killed() -> None:
    reading, writing = os.pipe()
    with subprocess.Popen([sys.executable, "-c", SERVER, str(writing)], pass_fds=[writing]) as server:
        os.close(writing)
        with os.fdopen(reading, "rb") as working:
            assert working.read(1) == b"!"
            server.kill()
            # Only the prover has the other end now.
            assert working.read() == b""


SPINNING = """process Give { out to : int in back : int
  communication { var b : int } composition { BEFOREmu (to ! 1 ; back ? b) } }
process Take { in from : int out back : int communication { var f : int } composition { mu (from ? f ; back ! f) } }
process Spin {
  communication {
    give : Give
    take : Take
    give.to -> take.from
    take.back -> give.back
  }
  composition { give || take }
}
assert Spin livelock free
"""


@pytest.mark.asyncio
@pytest.mark.parametrize("before", [[], ["give.to 5", "take.back 5"]])
async def test_the_steps_to_a_livelock_end_with_the_loop(tmp_path: Path, before: list[str]) -> None:
    text = SPINNING.replace("BEFORE", "to ! 5 ; back ? b ; " if before else "")
    session, uri = Session(), (tmp_path / "spin.csp").as_uri()
    view = session.view(session.documents.open(uri, text, 1))
    (answer,) = await prove(view.main, {}, text.index("assert"))
    assert [each["text"] for each in answer.steps] == [
        *before,
        "give.to 1, again and again",
        "take.back 1, again and again",
    ]
    assert {"give", "take", "give.to -> take.from"} <= set(answer.steps[-2]["communicating"])
    assert {"give", "take", "take.back -> give.back"} <= set(answer.steps[-1]["communicating"])


@pytest.mark.asyncio
async def test_a_loop_without_communications_is_one_step(tmp_path: Path) -> None:
    text = """process Busy {
  communication { var n : int = 0 }
  composition { mu (skip -> skip [] skip -> n := 1) until n == 1 }
}
process Main { communication { busy : Busy } composition { busy } }
assert Main livelock free
"""
    session, uri = Session(), (tmp_path / "busy.csp").as_uri()
    view = session.view(session.documents.open(uri, text, 1))
    (answer,) = await prove(view.main, {}, text.index("assert"))
    assert [(each["process"], each["text"]) for each in answer.steps] == [
        ("Main", "busy, again and again, without a communication or a delay")
    ]
    assert "busy" in answer.steps[0]["communicating"]


WAITING = """process Ticks { composition { mu (wait 1 s) } }
assert Ticks terminates
"""
TWICE = """process Once { in a : int communication { var v : int } composition { a ? v ; stop } }
process Twice { in a : int communication { var v : int } composition { a ? v ; a ? v } }
assert Twice refines Once
"""


@pytest.mark.asyncio
async def test_the_last_step_says_what_is_wrong(tmp_path: Path) -> None:
    session = Session()

    async def last(name: str, text: str) -> dict[str, object]:
        view = session.view(session.documents.open((tmp_path / name).as_uri(), text, 1))
        (answer,) = await prove(view.main, {}, text.index("assert"))
        return dict(answer.steps[-1])

    # It has no communication diagram.
    assert await last("ticks.csp", WAITING) == {
        "process": "Ticks",
        "text": "wait 1 s of Ticks, again and again",
        "communicating": ["step-1.1"],
        "waiting": [],
    }
    assert await last("twice.csp", TWICE) == {
        "process": "Twice",
        "text": "it does `a`, where the specification allows nothing more",
        "communicating": [],
        "waiting": [],
    }
