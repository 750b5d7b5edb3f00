"""What docs/hosts.md shows works as it is shown."""

from __future__ import annotations

import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cspdiag
from tests.simulate.hosts.places import Air, begin, trace

PAGE = (Path(__file__).parents[2] / "docs" / "hosts.md").read_text(encoding="utf-8")
(PROGRAM,) = re.findall(r"```csp\n(.*?)```", PAGE, re.DOTALL)


def test_the_program_ends_after_five_seconds_with_the_trace_of_one_process() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        places = [begin(pool, PROGRAM, place, air) for place in ("left", "right")]
        runs = [place.result(timeout=60) for place in places]
    assert [run.outcome.time for run in runs] == [5 * 10**9] * 2
    assert trace(*runs) == trace(cspdiag.parse(PROGRAM).run(level=0))


def test_the_handler_catches_what_the_page_shows() -> None:
    (handler,) = re.findall(r"```csp-fragment\n\s*(.*?)\n\s*```", PAGE, re.DOTALL)
    assert "composition {\n    mu (received ? n ; value ! n) until" in PROGRAM
    changed = PROGRAM.replace("mu (received ? n ; value ! n) until", f"{handler} until")
    assert cspdiag.parse(changed).check() == []
