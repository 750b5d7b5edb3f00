"""Changes of parameters of a program while it runs, from lines such as ``at 2 s gains.kp = 3``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from cspdiag.runtime.kernel.durations import shown
from cspdiag.settings import SettingError, constant_setting, parse_duration, split_setting

if TYPE_CHECKING:
    from cspdiag.model.program import Program
    from cspdiag.runtime.kernel.parameters import Change

_AT = re.compile(r"at\s+(?P<time>-?\s*[0-9][0-9.eE+-]*\s*[A-Za-z]+)\s+(?P<setting>[^\s=].*)", re.DOTALL)
_BEGINS_WITH_AT = re.compile(r"at\s+[^\s=.\[]")
"""A parameter may be called `at`, too."""
_REMARK = re.compile(r"\s*(?:#|//).*")


def parse_line(program: Program, line: str, now: int) -> Change | None:
    """The change that a line describes, ``now`` (nanoseconds) if it names no time; None for a line without one: it is
    empty, or a remark. Raises SettingError.
    """
    text = _REMARK.sub("", line).strip()
    if not text:
        return None
    timed = _AT.fullmatch(text)
    if timed is None and _BEGINS_WITH_AT.match(text):
        raise SettingError(f"a change at an instant is at TIME NAME=VALUE, such as at 2 s gain=3, not {text!r}")
    time = now if timed is None else parse_duration(timed["time"])
    return parse_change(program, time, *split_setting(text if timed is None else timed["setting"]))


def parse_change(program: Program, time: int, name: str, text: str) -> Change:
    """The change of a parameter, or of a field or an element of one, at a time in nanoseconds. Raises SettingError."""
    from cspdiag.runtime.kernel.parameters import Change

    if time < 0:
        raise SettingError(f"{name}={text}: a run has no instant {shown(time)}: it begins at 0 s")
    constant, positions, value = constant_setting(program, name, text)
    if not constant.tunable:
        own = constant.name.text
        how = "follows from parameters" if constant in program.tunable else "is a constant, which --set can set before"
        raise SettingError(f"{own} does not change by itself while the program runs: it {how}")
    return Change(time, constant.name.text, positions, value)
