"""The generators of programs whose parameters change while they run, and a few of their programs on the Python
targets.
"""

from __future__ import annotations

import re

import pytest

from cspdiag.base import SourceFile
from tests.conformance.random.changes import changes_in, changes_of
from tests.conformance.random.compare import LEAST, communications, difference
from tests.conformance.random.nodes import Program
from tests.conformance.random.parametrized import parametrized
from tests.conformance.random.tuned import tuned
from tests.conformance.sources import network_of


def test_most_programs_are_correct_and_communicate_often() -> None:
    made = [communications(str(tuned(seed))) for seed in range(12)]
    correct = [count for count in made if count is not None]
    assert len(correct) >= 10
    assert sum(count >= 5 * LEAST for count in correct) >= len(correct) / 2


def test_programs_reset_laws_in_arrays_and_are_changed_several_times_at_one_instant() -> None:
    texts = [str(tuned(seed)) for seed in range(60)]
    assert sum(bool(re.search(r"reset cell\d\[", text)) for text in texts) >= 15
    instants = [re.findall(r"^// at (\d+) ns", text, re.MULTILINE) for text in texts]
    assert sum(len({*times}) < len(times) for times in instants) >= 30
    assert sum(bool(re.search(r"^// at .* = (inf|-inf|nan)$", text, re.MULTILINE)) for text in texts) >= 20


def test_changes_are_those_of_the_text() -> None:
    text = "struct S { a : int  b : time }\nparameter s : S[2] = [S(a = 1, b = 1 ms), S(a = 2, b = 1 ms)]\n"
    text += "process P { out o : int  composition { o ! s[1].a } }\nenvironment E for P { o -> _ }\n"
    text += "// at 5 ns s[1].b = 7 ns\n"
    network = network_of(SourceFile(name="s.csp", text=text))
    with changes_in(text):
        assert changes_of(network) == [(5, "s", (1, 1), 7)]
    assert len(changes_of(network)) > 1


def test_constants_and_literals_of_other_programs_become_parameters() -> None:
    texts = [str(parametrized(seed)) for seed in range(20)]
    assert all("parameter " in text for text in texts)
    assert sum(bool(re.search(r"(after|wait|at) (hold|rest|long|short|late|pause)\b", text)) for text in texts) >= 10


PROGRAMS = [tuned(2), tuned(6), tuned(9), parametrized(1), parametrized(4), parametrized(10)]


@pytest.mark.parametrize("program", PROGRAMS, ids=range(len(PROGRAMS)))
def test_readable_and_optimized_python_do_as_the_reference(program: Program) -> None:
    assert difference(str(program), ("python-O0", "python-O1")) == ""
