"""Freedom from livelock that is proved once for all elements of arrays holds for each, and nothing is claimed where
elements can continue forever among themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.obligations import ProofObligations, proof_obligations
from cspdiag.proofs.answers.at_once import answers_at_once
from cspdiag.proofs.properties.livelock import livelock_free
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.verdict import Limits, Proved
from tests.support.counting import lines
from tests.support.joined_arrays import joined_arrays, pausing, served_array

SIZE = 230
"""More than are always examined one by one."""

STAGES = """const size = 230
process Source { out o : int composition { mu (wait 1 ms ; o ! 1) } }
process Stage { in i : int out o : int communication { var x : int } composition { mu (i ? x ; o ! x) } }
process Sink { in i : int communication { var x : int } composition { mu i ? x } }
process Whole {
  communication {
    source : Source  stage[size] : Stage  sink : Sink
    source.o -> stage[0].i
    for i < size - 1 { stage[i].o -> stage[i + 1].i }
    stage[size - 1].o -> sink.i
  }
  composition { source || (par i < size : stage[i]) || sink }
}
assert Whole livelock free
"""

RING = """const size = 230
process Head { in i : int out o : int communication { var x : int = 0 } composition { mu (o ! x ; wait 1 ms ; i ? x) } }
process Cell { in i : int out o : int communication { var x : int = 0 } composition { mu (i ? x ; o ! x) } }
process Whole {
  communication {
    head : Head  cell[size] : Cell
    head.o -> cell[0].i
    for i < size - 1 { cell[i].o -> cell[i + 1].i }
    cell[size - 1].o -> head.i
  }
  composition { head || (par i < size : cell[i]) }
}
assert Whole livelock free
"""

STAR = """const size = 230
process Client {
  out q : int in a : int communication { var x : int = 0 }
  composition { mu (wait 1 ms ; q ! x ; a ? x) }
}
process Server {
  in q[size] : int out a[size] : int communication { var x : int }
  composition { mu (alt i < size : q[i] ? x -> a[i] ! x) }
}
process Whole {
  communication {
    server : Server  client[size] : Client
    for i < size { client[i].q -> server.q[i]  server.a[i] -> client[i].a }
  }
  composition { server || (par i < size : client[i]) }
}
assert Whole livelock free
"""


def is_claimed(text: str) -> bool:
    """Whether freedom from livelock is proved once for all elements."""
    checked = pipeline.check(SourceFile(name="main.csp", text=text), read_source, for_findings=True)
    assert not checked.report.has_errors, checked.report.diagnostics
    assert checked.program is not None
    if checked.fewer is None:
        return False
    few = checked.fewer.checked
    _, answers = answers_at_once(
        checked.program, checked.fewer.varying, None, lambda name: pipeline.compile_network(few, top=name)
    )
    return bool(answers)


def holds_for_each(text: str) -> bool:
    """Whether the same is proved with a component for each element, by loops or a search of all states."""
    network = pipeline.build(SourceFile(name="main.csp", text=text), read_source).network
    assert network is not None
    return isinstance(livelock_free(transition_system(network), Limits()), Proved)


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


@pytest.mark.parametrize(
    "text",
    [
        STAGES,
        changed(changed(STAGES, "wait 1 ms ; ", ""), "mu i ? x", "mu (i ? x ; wait 1 ms)"),
        changed(changed(STAGES, "wait 1 ms ; ", ""), "mu (i ? x ; o ! x)", "mu (i ? x ; wait 1 ms ; o ! x)"),
        changed(changed(STAGES, "wait 1 ms ; ", ""), "mu i ? x", "i ? x"),
        RING,
        changed(RING, "mu (o ! x ; wait 1 ms ; i ? x)", "o ! x ; i ? x"),
        STAR,
        changed(changed(STAR, "wait 1 ms ; ", ""), "-> a[i] ! x", "-> (wait 1 ms ; a[i] ! x)"),
    ],
    ids=["slow source", "slow sink", "slow stages", "one value is taken", "slow head", "one round", "slow clients",
         "slow server"],
)  # fmt: skip
def test_elements_that_wait_for_time_directly_or_through_others_have_no_livelock(text: str) -> None:
    assert is_claimed(text)
    assert not is_claimed(text.replace(str(SIZE), "10"))
    assert holds_for_each(text.replace(str(SIZE), "10"))


@pytest.mark.parametrize(
    "text",
    [
        changed(STAGES, "wait 1 ms ; ", ""),
        changed(changed(STAGES, "wait 1 ms ; ", ""), "mu (i ? x ; o ! x)",
                "mu (i ? x ; (if x == 100 then skip else wait 1 ms) ; o ! x)"),
        changed(RING, "wait 1 ms ; ", ""),
        changed(RING, "wait 1 ms ; ", "wait 0 ms ; "),
        changed(RING, "cell[i].o -> cell[i + 1].i", "cell[i].o -> cell[(i + 1) % (size - 1)].i").replace(
            "head.o -> cell[0].i", "head.o -> cell[size - 1].i"),
        changed(STAR, "wait 1 ms ; ", ""),
        changed(changed(STAR, "wait 1 ms ; q ! x", "wait 1 ms ; mu q ! x"), "a[i] ! x", "skip"),
    ],
    ids=["no delay", "a value decides", "no delay around", "no time passes", "a ring beside the head",
         "no delay of clients", "one delay at the beginning"],
)  # fmt: skip
def test_nothing_is_claimed_where_elements_may_continue_among_themselves(text: str) -> None:
    assert not is_claimed(text)


@pytest.mark.parametrize(
    ("program", "seeds", "least"),
    [(joined_arrays, (0, 5, 9, 10, 19, 20, 29, 30), 7), (served_array, (2, 7, 16, 19, 20), 5)],
    ids=["joined", "served"],
)
def test_what_is_claimed_holds_for_each_element(
    program: Callable[[int, int], str], seeds: Iterable[int], least: int
) -> None:
    claimed = 0
    for seed in seeds:
        size = SIZE + seed % 24
        if is_claimed(pausing(program(seed, size), seed)):
            few = pausing(program(seed, 6 + size % 2), seed)
            assert holds_for_each(few), few
            claimed += 1
    assert claimed >= least


def test_a_hundred_times_as_many_elements_take_hardly_more_steps() -> None:
    def steps(size: int) -> int:
        text = STAGES.replace(str(SIZE), str(size))
        return lines(lambda: is_claimed(text))

    steps(SIZE)
    assert steps(100 * SIZE) < 2 * steps(SIZE)


@pytest.mark.parametrize("written", ["10", "300"])
def test_sizes_may_be_set(written: str) -> None:
    def found(settings: dict[str, str]) -> ProofObligations:
        text = STAGES.replace("const size = 230", f"const size = {written}")
        text = text.replace("process Stage {", "process Stage(gain : int = 1) {").replace("o ! x", "o ! x * gain")
        return proof_obligations(SourceFile(name="main.csp", text=text), read_source, settings=settings)

    assert found({"size": "100000"}).answers
    assert not found({"size": "20"}).answers
    assert len(found({"size": "20"}).networks) == 0
    assert not found({"size": "400", "stage[399].gain": "2"}).answers
    assert found({"size": "400", "stage[399].gain": "2"}).parameters == {"stage[399].gain": 2}
    refused = found({"size": "0"}).checked.report
    assert refused.has_errors
    assert refused.suspects
