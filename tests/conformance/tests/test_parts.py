"""The generator of programs that deadlock between parallel parts, and a few of its programs on the Python targets."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from tests.conformance.random.compare import LIMIT, difference
from tests.conformance.random.parts import parts
from tests.conformance.sources import InvalidProgramError, network_of
from tests.conformance.targets import REFERENCE

SEEDS = range(40)


def test_most_programs_deadlock_and_some_of_them_between_parts() -> None:
    reports = []
    for seed in SEEDS:
        try:
            network = network_of(SourceFile(name="random.csp", text=str(parts(seed))))
        except InvalidProgramError:
            continue
        ending = REFERENCE.run(network, None, LIMIT).ending
        reports += [ending.message or ""] * (ending.ended == "deadlock")
    assert len(reports) >= len(SEEDS) / 2
    assert any("parallel parts of" in report for report in reports)
    assert any("no other process that still runs" in report for report in reports)


@pytest.mark.parametrize("seed", SEEDS)
def test_readable_and_optimized_python_report_what_the_reference_does(seed: int) -> None:
    try:
        assert difference(str(parts(seed)), ("python-O0", "python-O1")) == ""
    except InvalidProgramError:
        pytest.skip("not a correct program")
