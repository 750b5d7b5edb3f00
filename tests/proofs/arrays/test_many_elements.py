"""What is proved once for all elements of arrays holds for each, and nothing is claimed where it may depend on how many
there are.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.main import main
from cspdiag.obligations import ProofObligations, proof_obligations
from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.rules.marked_graph import Place, has_no_circle, order_of_events
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Proved
from tests.proofs.systems import naive
from tests.proofs.systems.known import compose, cycle
from tests.support.counting import lines
from tests.support.joined_arrays import joined_arrays, served_array

NETWORKS = Path(__file__).parents[3] / "benchmarks" / "networks"
SIZE = 230
"""More than are always examined one by one."""


def obligations(text: str) -> ProofObligations:
    return proof_obligations(SourceFile(name="main.csp", text=text), read_source)


def is_claimed(text: str) -> bool:
    """Whether freedom from deadlock and knots is proved once for all elements."""
    found = obligations(text)
    assert not found.checked.report.has_errors, found.checked.report.diagnostics
    return any(question.claim == "deadlock free" for question in found.answers)


def holds_for_each(text: str) -> bool:
    """Whether the same is proved with a component for each element."""
    network = pipeline.build(SourceFile(name="main.csp", text=text), read_source).network
    assert network is not None
    system = transition_system(network)
    rules = (prove_deadlock_free, prove_knot_free)
    return all(isinstance(proof(system, Limits(), ["rules"]), Proved) for proof in rules)


def benchmark(name: str, size: int) -> str:
    return re.sub(r"const size = \d+", f"const size = {size}", (NETWORKS / f"{name}.csp").read_text(encoding="utf-8"))


RING = """const size = 230

process Cell {
  in  input  : int
  out output : int

  communication {
    var value : int = 0
  }

  composition {
    mu (input ? value ; output ! value)
  }
}

process Head {
  in  input  : int
  out output : int

  communication {
    var value : int = 0
  }

  composition {
    mu (output ! value + 1 ; input ? value)
  }
}

process Ring {
  communication {
    head       : Head
    cell[size] : Cell

    head.output -> cell[0].input
    for i < size - 1 {
      cell[i].output -> cell[i + 1].input
    }
    cell[size - 1].output -> head.input
  }

  composition {
    head || (par i < size : cell[i])
  }
}

assert Ring deadlock free
"""


@pytest.mark.parametrize("text", [RING, *(benchmark(name, SIZE) for name in ("pipeline", "workers", "star"))])
def test_regular_networks_are_proved_once_for_all_elements(text: str) -> None:
    assert is_claimed(text)
    assert not is_claimed(text.replace(str(SIZE), "40"))
    assert holds_for_each(text.replace(str(SIZE), "40"))


ANSWER = "reply[i] ! question % 1000 + i"


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    "text",
    [
        changed(RING, ("mu (output ! value + 1 ; input ? value)", "mu (input ? value ; output ! value)")),
        changed(RING, ("mu (output ! value + 1 ; input ? value)", "output ! 1 ; mu (input ? value ; output ! value)")),
        changed(RING, ("output ! value)", "output ! value ; if value == 100 then stop)")),
        changed(RING, ("cell[i].output -> cell[i + 1]", "cell[i + 1].output -> cell[i]"),
                ("cell[size - 1].output -> head", "cell[0].output -> head"),
                ("head.output -> cell[0]", "head.output -> cell[size - 1]"),
                ("mu (output ! value + 1 ; input ? value)", "mu (input ? value ; output ! value)")),
        changed(benchmark("star", SIZE), (ANSWER, f"(request[i] ? question ; {ANSWER})")),
        changed(benchmark("star", SIZE), (ANSWER, f"((if question == 99 then stop) ; {ANSWER})")),
        changed(benchmark("star", SIZE), ("reply[i] ! ", "reply[(i + 1) % size] ! ")),
        changed(benchmark("star", SIZE), ("server.request[i]", "server.request[size - 1 - i]")),
    ],
    ids=["no token", "a beginning of its own", "a value that ends it", "no token backwards", "asks twice",
         "a question that ends it", "answers the next", "answers the opposite"],
)  # fmt: skip
def test_nothing_is_claimed_where_elements_wait_in_a_circle_or_depend_on_values(text: str) -> None:
    assert not is_claimed(text)


@pytest.mark.parametrize(
    ("program", "seeds", "least"),
    [(joined_arrays, range(17, 30), 5), (served_array, (1, 2, 5, 7, 16), 4)],
    ids=["joined", "served"],
)
def test_what_is_claimed_holds_for_each_element(
    program: Callable[[int, int], str], seeds: Iterable[int], least: int
) -> None:
    claimed = 0
    for seed in seeds:
        if obligations(program(seed, SIZE + seed)).answers:
            assert holds_for_each(program(seed, 12)), program(seed, 12)
            claimed += 1
    assert claimed >= least


def test_a_hundred_times_as_many_elements_take_hardly_more_steps() -> None:
    def steps(size: int) -> int:
        text = RING.replace(str(SIZE), str(size))
        return lines(lambda: obligations(text))

    steps(SIZE)
    assert steps(100 * SIZE) < 2 * steps(SIZE)


def test_a_method_that_is_chosen_is_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "ring.csp"
    path.write_text(RING, encoding="utf-8")
    for method, words in (("rules", "proved once for all elements"), ("stubborn", "representative states")):
        assert main(["verify", "--no-cache", "--method", method, str(path)]) == 0
        assert words in capsys.readouterr().err


def test_a_marked_graph_has_no_circle_exactly_if_it_has_neither_a_deadlock_nor_a_knot() -> None:
    live = 0
    for seed in range(300):
        system = _random_marked_graph(random.Random(seed))
        states = [state for layer in naive.layers(system) for state in layer]
        expected = not any(naive.deadlocked(system, state) or naive.knotted(system, state) for state in states)
        assert has_no_circle(_places(system)) == expected, seed
        live += expected
    assert 30 < live < 270


def _random_marked_graph(chosen: random.Random) -> System:
    events: list[list[str]] = [[] for _ in range(chosen.randint(2, 5))]
    for number in range(chosen.randint(2, 6)):
        for component in chosen.sample(range(len(events)), 2):
            events[component].append(f"e{number}")
    for order in events:
        chosen.shuffle(order)
    return compose([cycle(f"p{at}", *order) for at, order in enumerate(events) if order])


def _places(system: System) -> list[Place]:
    structure = Structure(system)
    found = []
    for shape, events in zip(structure.shapes, structure.events, strict=True):
        order = order_of_events(shape)
        assert order is not None
        found += [Place(events[before], events[after], 0, 0) for before, after in pairwise(order)]
    return found


@pytest.mark.parametrize(
    ("places", "expected"),
    [
        ([("a", "a", 1, 1)], True),
        ([("a", "a", -3, -1)], True),
        ([("a", "a", -1, 1)], False),
        ([("a", "b", 0, 0), ("b", "a", 0, 0)], False),
        ([("a", "b", 0, 0), ("b", "a", 1, 4)], True),
        ([("a", "b", 0, 2), ("b", "a", 0, 1)], False),
        ([("a", "b", 1, 1), ("b", "a", -1, -1)], False),
        ([("a", "b", 1, 1), ("b", "c", -5, 5)], True),
    ],
)
def test_indexes_cannot_only_grow_around_a_circle(places: list[tuple[str, str, int, int]], *, expected: bool) -> None:
    assert has_no_circle(Place(*place) for place in places) is expected
