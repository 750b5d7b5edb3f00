"""Changes of the parameters of a program, from lines such as ``at 2 s gains.kp = 3``.

Values are written as in the text of the program, numbers without their unit.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from threading import Thread
from typing import Any

from .compiled.arithmetic import duration
from .kernel.durations import duration_of
from .kernel.parameters import Change, Parameter, ProgramParameters
from .network import Network
from .outside import accepted

Report = Callable[[str], object]
"""Is given a line about a line that is wrong."""

_AT = re.compile(r"at\s+(?P<time>[0-9.]+\s*[a-z]+)\s+(?P<setting>.*)", re.DOTALL)
_REMARK = re.compile(r"\s*(?:#|//).*")
_STEP = re.compile(r"\.\s*(?P<field>\w+)|\[\s*(?P<element>\d+)\s*\]")
_STANDARD_INPUT = 0


def changes_in(
    parameters: ProgramParameters, lines: Iterable[str], report: Report, now: Callable[[], int] = lambda: 0
) -> Iterator[Change]:
    """The changes in lines; one without a time is for the instant ``now`` (nanoseconds). A wrong line is reported, and
    left out.
    """
    for number, line in enumerate(lines, start=1):
        try:
            change = _parsed(parameters, line, now())
        except ValueError as problem:
            report(f"--tune, line {number}: {problem}")
        else:
            if change is not None:
                yield change


def read_while_running(network: Network, report: Report) -> None:
    """Change the parameters of a network by lines from standard input, as they come, in a thread of its own."""

    def work() -> None:
        for change in changes_in(network.parameters, _lines_of_standard_input(), report, lambda: network.now):
            network.parameters.plan([change])

    Thread(target=work, name="tuning", daemon=True).start()


def _lines_of_standard_input() -> Iterator[str]:
    """Without ``sys.stdin``, whose lock this thread would hold when the interpreter ends."""
    rest = b""
    while data := os.read(_STANDARD_INPUT, 1 << 12):
        *lines, rest = (rest + data).split(b"\n")
        yield from (line.decode("utf-8", "replace") for line in lines)
    yield rest.decode("utf-8", "replace")


def _parsed(parameters: ProgramParameters, line: str, now: int) -> Change | None:
    text = _REMARK.sub("", line).strip()
    if not text:
        return None
    timed = _AT.fullmatch(text)
    name, equals, value = (text if timed is None else timed["setting"]).partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"a change is NAME = VALUE, or at TIME NAME = VALUE, not {text!r}")
    time = now if timed is None else duration_of(timed["time"])
    parameter, path, accept = _meant(parameters, name.strip())
    try:
        return Change(time, parameter, path, _value(value.strip(), accept))
    except ValueError as problem:
        raise ValueError(f"{name.strip()}: {problem}") from None


def _meant(parameters: ProgramParameters, name: str) -> tuple[str, tuple[int, ...], Any]:
    """The parameter that a name begins with, the positions of the part of it that is meant, and what accepts that."""
    known = {one.name: one for one in vars(parameters).values() if isinstance(one, Parameter)}
    head = re.split(r"[.\[]", name, maxsplit=1)[0].strip()
    if head not in known:
        raise ValueError(f"there is no parameter {name!r} (there are: {', '.join(parameters.names)})")
    accept: Any = known[head].accepts
    if accept is None:
        raise ValueError(f"{head} does not change by itself: it follows from parameters")
    path: list[int] = []
    at = len(head)
    while at < len(name):
        step = _STEP.match(name, at)
        parts = _parts(accept)
        key = "" if step is None else step["field"] or f"[{step['element']}]"
        if step is None or key not in parts:
            listed = f"these parts: {', '.join(parts)}" if parts else "no parts"
            raise ValueError(f"there is no {name!r}: {name[:at]} has {listed}")
        path.append(list(parts).index(key))
        accept = parts[key]
        at = step.end()
    return head, tuple(path), accept


def _parts(accept: Any) -> dict[str, Any]:
    """What accepts each part of a value, by ``field`` or ``[0]``. Fields whose names Python reserves end in ``_``."""
    match accept:
        case partial(func=accepted.take_elements, args=(element, size)):
            return {f"[{at}]": element for at in range(size)}
        case partial(func=accepted.take_fields, args=(made, fields)):
            return dict(zip((name.removesuffix("_") for name in made._fields), fields, strict=True))
        case _:  # Anything else is one value.
            return {}


def _value(text: str, accept: Any) -> Any:
    """The value that a text means to a parameter or a part of one. Raises ValueError."""
    if parts := _parts(accept):
        raise ValueError(f"set one of its parts: {', '.join(parts)}")
    match accept:
        case partial(func=accepted.take_integer, args=(of,)) if of is duration:
            return -duration_of(text[1:]) if text.startswith("-") else duration_of(text)
        case partial(func=accepted.take_integer):
            if not re.fullmatch(r"[+-]?\d+", text):
                raise ValueError(f"{text!r} is no integer")
            return int(text)
        case partial(func=accepted.take_member, args=(enum,)):
            names = {member.name.removesuffix("_"): member for member in enum}
            literal = text.removeprefix(f"{enum.__name__}.")
            if literal not in names:
                raise ValueError(f"{text!r} is none of {', '.join(names)}")
            return names[literal]
        case accepted.boolean:
            if text not in ("true", "false"):
                raise ValueError(f"{text!r} is neither true nor false")
            return text == "true"
        case _:  # A number of either size.
            try:
                return float(text)
            except ValueError:
                raise ValueError(f"{text!r} is not a number; its unit is that of the parameter") from None
