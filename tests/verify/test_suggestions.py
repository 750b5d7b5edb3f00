"""Suggested changes of the text remove the deadlock; the text after each of them is proved."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from cspdiag.base import Report, SourceFile, Span
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.findings import diagnostic_of
from cspdiag.proofs.counterexamples.suggestion import Suggestion
from cspdiag.proofs.counterexamples.words import waiting_lines
from cspdiag.proofs.verdict import Limits
from cspdiag.syntax import ast
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from cspdiag.verify import suggest
from cspdiag.verify.confirm import Verifier

DINING = {
    name: (Path(__file__).parents[2] / "models/dining" / name).read_text() for name in ("deadlock.csp", "table.csp")
}

GATES = """/// A lock of a canal, and a bridge over it: each opens when the other is closed.
process Gate {
  in  closed : bool
  out opened : bool

  communication {
    var free : bool = true
  }

  composition {
    mu (closed ? free ; opened ! free)
  }
}

process Canal {
  communication {
    lock   : Gate
    bridge : Gate

    lock.opened   -> bridge.closed
    bridge.opened -> lock.closed
  }

  composition {
    lock || bridge
  }
}

assert Canal deadlock free
"""

STATIONS = """/// A station of a line asks the next one whether there is room, and answers the one before.
process Station(first: bool) {
  in  asked  : bool
  out answer : bool
  out ask    : bool
  in  reply  : bool

  communication {
    var room : bool = true
  }

  composition {
    mu (
      ask ! first ;
      reply ? room ;
      asked ? room ;
      answer ! room
    )
  }
}

process Line {
  communication {
    station[i < 3] : Station(first = i == 0)

    for i < 3 {
      station[i].ask              -> station[(i + 1) % 3].asked
      station[(i + 1) % 3].answer -> station[i].reply
    }
  }

  composition {
    par i < 3 : station[i]
  }
}

assert Line deadlock free
"""

ROBOTS = """/// Is lent to one robot at a time.
process Tool {
  in left, right : bool

  communication {
    var lent : bool = false
  }

  composition {
    mu (left ? lent -> left ? lent [] right ? lent -> right ? lent)
  }
}

process Robot {
  out first, second : bool

  composition {
    mu (first ! true ; second ! true ; wait 200 ms ; second ! false ; first ! false)
  }
}

process Cell {
  communication {
    gripper : Tool
    fixture : Tool
    a       : Robot
    b       : Robot

    a.first  -> gripper.left
    a.second -> fixture.left
    b.first  -> fixture.right
    b.second -> gripper.right
  }

  composition {
    gripper || fixture || a || b
  }
}

assert Cell deadlock free
"""


HANDLING = """/// Is taken and given back by either side.
process Tool {
  in takeA, giveA, takeB, giveB : bool

  communication {
    var lent : bool = false
  }

  composition {
    mu (takeA ? lent -> giveA ? lent [] takeB ? lent -> giveB ? lent)
  }
}

process Robot {
  out takeFirst, takeSecond, giveFirst, giveSecond : bool

  composition {
    mu (takeFirst ! true ; takeSecond ! true ; wait 20 ms ; giveSecond ! true ; giveFirst ! true)
  }
}

process Cell {
  communication {
    left    : Robot
    right   : Robot
    gripper : Tool
    belt    : Tool

    left.takeFirst   -> gripper.takeA
    left.giveFirst   -> gripper.giveA
    left.takeSecond  -> belt.takeA
    left.giveSecond  -> belt.giveA
    right.takeFirst  -> belt.takeB
    right.giveFirst  -> belt.giveB
    right.takeSecond -> gripper.takeB
    right.giveSecond -> gripper.giveB
  }

  composition {
    left || right || gripper || belt
  }
}

assert Cell deadlock free
"""


@pytest.fixture(autouse=True)
def time_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suggest, "SECONDS", 60.0)


def answer_of(files: dict[str, str], main: str, settings: dict[str, str] | None = None) -> Answer:
    """The answer to whether a program is free from deadlock."""

    def read(path: str) -> SourceFile:
        return SourceFile(name=path, text=files[Path(path).name])

    question = proof_obligations(read(main), read, settings=settings)
    return Verifier(question, read, settings=settings).answer(question.questions[0], Limits(20.0))


def suggested(
    files: dict[str, str], main: str = "case.csp", settings: dict[str, str] | None = None
) -> list[Suggestion]:
    """The suggestions; each keeps all ports, and the program is proved with it."""
    answer = answer_of(files, main, settings)
    assert answer.outcome == "refuted"
    for suggestion in answer.suggestions:
        name = suggestion.span.file
        assert ports(suggestion.text) == ports(files[name]) != []
        if suggestion.proved_with is None:
            assert answer_of(files | {name: suggestion.text}, main, settings).outcome == "proved", suggestion.words
    return list(answer.suggestions)


def ports(text: str) -> list[str]:
    """The declarations of ports, or if there are none the definitions of a text."""
    tree = parse(SourceFile(name="a.csp", text=text), Report())
    processes = [item for item in tree.items if isinstance(item, ast.ProcessDefinition)]
    declared = [port.span.text for process in processes for port in process.ports]
    return declared or [process.name.text for process in processes]


def test_the_last_philosopher_takes_its_forks_in_the_other_order() -> None:
    first, *_ = suggested(DINING, "deadlock.csp", {"seats": "4"})
    assert first.words == (
        "another order of what `philosopher[seats - 1]` takes: exchange its connections `first` and `second` "
        "(deadlock.csp:9)"
    )
    assert first.difference == (
        "-    for i < seats {",
        "+    for i < seats - 1 {",
        "+    philosopher[seats - 1].second -> fork[seats - 1].left",
        "+    philosopher[seats - 1].first  -> fork[0].right",
    )
    assert first.text == format_tree(parse(SourceFile(name="deadlock.csp", text=first.text), Report()))


def test_a_large_table_gets_the_suggestions_of_a_small_one() -> None:
    small, large = (suggested(DINING, "deadlock.csp", {"seats": seats}) for seats in ("3", "6"))
    assert len(small) == 2
    assert [suggestion.words for suggestion in large] == [suggestion.words for suggestion in small]
    assert large[0].replacement == small[0].replacement


def test_a_process_with_a_name_of_its_own_takes_in_the_other_order_what_it_takes() -> None:
    found = suggested({"case.csp": ROBOTS})
    words = [suggestion.words for suggestion in found]
    assert words[0] == "another order of what `a` takes: exchange its connections `first` and `second` (case.csp:29)"
    assert found[0].difference == (
        "-    a.first  -> gripper.left",
        "-    a.second -> fixture.left",
        "+    a.second -> gripper.left",
        "+    a.first  -> fixture.left",
    )


def test_connections_are_exchanged_that_play_the_same_part() -> None:
    words = [suggestion.words for suggestion in suggested({"case.csp": HANDLING})]
    assert [line.partition(" (")[0] for line in words] == [
        "another order of what `left` takes: exchange its connections `takeFirst` and `takeSecond`",
        "another order of what `right` takes: exchange its connections `takeFirst` and `takeSecond`",
    ]


def test_a_gate_that_asks_before_it_serves_may_do_either() -> None:
    words = [suggestion.words for suggestion in suggested({"case.csp": GATES})]
    assert words == ["serve `closed ? free` and `opened ! free` in any order: join them by `[]` (case.csp:11)"]


def test_stations_answer_while_they_want_to_ask() -> None:
    (found,) = suggested({"case.csp": STATIONS})
    assert found.words == "serve `ask ! first` and `asked ? room` in any order: join them by `[]` (case.csp:14)"
    assert found.difference == (
        "-      ask ! first ;",
        "-      reply ? room ;",
        "-      asked ? room ;",
        "-      answer ! room",
        "+      ask ! first -> reply ? room",
        "+      []",
        "+      asked ? room -> answer ! room",
    )


def test_partners_that_have_ended_are_reported() -> None:
    robots = ROBOTS.replace("mu (first ! true", "(first ! true").replace(
        "b.first  -> fixture.right", "b.first  -> gripper.right"
    )
    answer = answer_of(
        {"case.csp": robots.replace("b.second -> gripper.right", "b.second -> fixture.right")}, "case.csp"
    )
    assert answer.counterexample is not None
    assert [(entry.name, entry.ended) for entry in answer.counterexample.waiting] == [
        ("gripper", ("a", "b")),
        ("fixture", ("a", "b")),
    ]
    assert next(waiting_lines(answer.counterexample)).endswith("for `a`, `b`, which have ended")
    found = diagnostic_of(answer)
    assert found is not None
    assert found.help == "`gripper`, `fixture` outlive `a`, `b`: let all of them end, or none"


def test_the_lines_of_a_change_are_replaced() -> None:
    source = SourceFile(name="a.csp", text="one\ntwo\nthree\n")
    change = Suggestion("", Span(source, 4, 7), "2")
    assert change.text == "one\n2\nthree\n"
    styled = change.in_text("one\n  2\n  2\nthree\n")
    assert (styled.span.text, styled.replacement) == ("two\n", "  2\n  2\n")
    assert styled.text == "one\n  2\n  2\nthree\n"
    assert styled.difference == ("-two", "+  2", "+  2")


def test_what_is_suggested_does_not_depend_on_the_load(monkeypatch: pytest.MonkeyPatch) -> None:
    began, clock = time.monotonic(), time.monotonic
    monkeypatch.setattr(suggest, "SECONDS", 10.0)
    monkeypatch.setattr(time, "monotonic", lambda: began + 100 * (clock() - began))

    def read(path: str) -> SourceFile:
        return SourceFile(name=path, text=DINING[Path(path).name])

    question = proof_obligations(read("deadlock.csp"), read)
    answer = Verifier(question, read).answer(question.questions[0], Limits(1e6))
    assert answer.suggestions
    assert [suggestion.proved_with for suggestion in answer.suggestions] == [None] * len(answer.suggestions)
