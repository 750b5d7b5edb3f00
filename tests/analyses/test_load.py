"""When a program is lowered for its load: only if a simple bound of it exceeds the processor."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from cspdiag.pipeline import Checked, check

PROGRAM = """
const HALF : time = 500 us
submodel Law wcet {wcet} {{
  in  y : double
  out u : double
  u = -y
}}
process Main {{
  in  y : double @ 1 ms
  in  slow : double @ 10 ms
  out u    : double @ 1 ms
  out v    : double @ 10 ms
  communication {{
    first  : Law
    second : Law
    y    -> first.y
    slow -> second.y
    first.u  -> u
    second.u -> v
  }}
  composition {{ {composition} }}
}}
"""


def checked(wcet: str, composition: str) -> Checked:
    source = SourceFile(name="load.csp", text=PROGRAM.format(wcet=wcet, composition=composition))
    return check(source, lambda name: pytest.fail(f"reads {name}"))


@pytest.mark.parametrize(
    ("wcet", "composition", "is_lowered", "percent"),
    [
        ("100 us", "mu first || mu second", False, None),
        ("HALF", "mu first || mu second", False, None),
        ("501 us", "mu first || mu second", True, None),
        ("900 us", "mu first || mu second", True, None),
        ("950 us", "mu first || mu second", True, "104"),
        ("300 us", "mu (first ; first ; first) || mu second", True, None),
        ("950 us", "mu first || (wait 1 s ; mu second)", True, "104"),
        ("950 us", "mu first || (stop ; mu second)", True, None),
        ("950 us", "mu first || (mu wait 1 s ; mu second)", True, None),
    ],
)
def test_a_program_is_lowered_only_if_its_laws_may_need_more_than_the_processor(
    wcet: str, composition: str, is_lowered: bool, percent: str | None
) -> None:
    found = checked(wcet, composition)
    loads = [one for one in found.report.diagnostics if one.code == "W0710"]
    if found.report.has_errors:
        pytest.fail(str([one.message for one in found.report.diagnostics]))
    assert (found.network is not None) == is_lowered
    assert [f"{percent} %" in one.message for one in loads] == ([] if percent is None else [True])
