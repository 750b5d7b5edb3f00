"""A program with arrays has the mistakes, the network and the generated Python of the same program line by line."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from cspdiag import pipeline
from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from tests.support.unrolled import pair

PLACES = re.compile(r"# main\.csp:.*|main\.csp:\d+")
"""Where something is in the text, in generated code."""

SIZE = 7
UNREACHED = "W0611"
"""A step of a loop is reached if any of its iterations is; a line only if itself is."""


def checked(text: str) -> pipeline.Checked:
    return pipeline.check(SourceFile(name="main.csp", text=text), read_source)


def wording(found: Diagnostic) -> tuple[str, str]:
    return found.code, found.message.replace("again in each step of `for`", "twice")


def test_an_array_has_the_mistakes_and_the_network_of_its_lines() -> None:
    found: Counter[str] = Counter()
    for seed in range(150):
        array, lines = map(checked, pair(seed, SIZE))
        of_array, of_lines = ({wording(one) for one in form.report.diagnostics} for form in (array, lines))
        codes = {code for code, _ in of_array}
        # A place is reported once, for the first of its elements.
        assert codes | {UNREACHED} == {code for code, _ in of_lines} | {UNREACHED}, (seed, of_array ^ of_lines)
        assert of_array <= of_lines, (seed, of_array - of_lines)
        found.update(codes or {"none"})
        if not array.report.has_errors:
            one, other = (pipeline.compile_network(form) for form in (array, lines))
            assert one is not None
            assert one == other, seed
    assert found["none"] > 15
    assert len(found) > 12, found


@pytest.mark.parametrize("level", [0, 1])
def test_the_python_of_an_array_is_that_of_its_lines(level: int) -> None:
    compared = 0
    for seed in range(40):
        forms = [checked(text) for text in pair(seed, SIZE)]
        networks = [pipeline.compile_network(form) for form in forms]
        if None not in networks:
            one, other = (
                {
                    name: PLACES.sub("", text)
                    for name, text in pipeline.generate(network, read_source, "python", level).items()
                }
                for network in networks
                if network is not None
            )
            assert one == other, seed
            compared += 1
    assert compared > 10
