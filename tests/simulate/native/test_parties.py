"""Who wrote and read a value that a native program reports."""

from __future__ import annotations

import shutil

import pytest

import cspdiag

pytestmark = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="there is no C compiler")

PROGRAM = """
submodel Gain(k: double) { in r : double  out u : double  u = k * r }
submodel Source { out r : double  r = 1 }
process Top {
  in  r  : double @ 1 ms
  out u0 : double @ 1 ms
  out u1 : double @ 1 ms
  communication {
    first  : Gain(k = 1)
    second : Gain(k = 2)
    r -> first.r   first.u -> u0
    r -> second.r  second.u -> u1
  }
  composition { (mu first) || (mu second) }
}
environment Bench for Top { source : Source  source.r -> r  u0 -> _  u1 -> _ }
"""


def users(target: str) -> dict[str, set[tuple[str, str]]]:
    """The writers and readers of each channel."""
    program = cspdiag.parse(PROGRAM, "program.csp")
    found: dict[str, set[tuple[str, str]]] = {}
    for passed in program.run(until="2ms", target=target).communications:
        found.setdefault(passed.channel, set()).add((passed.writer, passed.reader))
    return found


def test_of_several_laws_none_is_guessed() -> None:
    native, in_python = (users(target) for target in ("c", "python"))
    assert in_python.pop("Top.r") == {("", "Top.first"), ("", "Top.second")}
    assert native.pop("Top.r") == {("", "Top")}
    assert native == in_python == {"Top.u0": {("Top.first", "")}, "Top.u1": {("Top.second", "")}}
