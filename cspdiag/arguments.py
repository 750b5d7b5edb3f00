"""What callers from Python hand over, looked at before anything is done with it: a wrong value is refused in words."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING

from cspdiag.base import SourceFile
from cspdiag.base.errors import ArgumentError
from cspdiag.base.span import with_line_feeds

if TYPE_CHECKING:
    from cspdiag.draw.elements.communication import Drawn
    from cspdiag.draw.hiding import Hidden
    from cspdiag.draw.pictures import Pictures
    from cspdiag.network.ir.network import Environment, Network

LONGEST_LIMIT = 1e6
"""Seconds: longer than that no timer of a system needs to wait."""

Setting = str | int | float
"""A value as ``cspdiag run --set`` takes it (``"10 ms"``), or a plain number."""


def source_of(text: str, name: str) -> SourceFile:
    """A text as if it had been read from a file. Raises TypeError for what is no text, ArgumentError for what no file
    can hold.
    """
    if not isinstance(text, str):
        raise TypeError(f"a program is text, a str, and not {type(text).__name__}: `load` reads a file")
    zero = text.find("\0")
    if zero >= 0:
        raise ArgumentError(f"{name}: not text (a zero byte at offset {zero})")
    try:
        text.encode()
    except UnicodeEncodeError as problem:
        raise ArgumentError(f"{name}: not text (half a character at offset {problem.start})") from None
    return SourceFile(name=name, text=with_line_feeds(text.removeprefix("\ufeff")))


def settings_of(values: Mapping[str, Setting] | None) -> dict[str, str]:
    """Settings as the language writes them: ``True`` is ``true`` there."""
    return {
        name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in (values or {}).items()
    }


def time_limit(until: str | float) -> int:
    """How long a run lasts at most, in nanoseconds. Raises SettingError."""
    from cspdiag.settings import parse_time_limit

    if isinstance(until, str):
        return parse_time_limit(until)
    return parse_time_limit(f"{until if isinstance(until, bool) else float(until)!r} s")


def require_one_of(what: str, value: object, known: Collection[object]) -> None:
    """Raise ArgumentError for a value that there is not."""
    if value not in known:
        raise ArgumentError(f"unknown {what} {value!r} (there are: {', '.join(map(str, known))})")


def require_seconds(what: str, seconds: float) -> None:
    """Raise ArgumentError for what is no positive time, or longer than a timer of the system can wait."""
    if not 0 < seconds <= LONGEST_LIMIT:
        raise ArgumentError(f"{what} is a positive number of seconds up to {LONGEST_LIMIT:g}, not {seconds!r}")


def measured_times(network: Network, measured: Mapping[str, float] | None) -> dict[str, int]:
    """Execution times in nanoseconds, from seconds by path. Raises ArgumentError for a path or a time that there is
    not.
    """
    from cspdiag.network.lower.program import suggestion

    paths = {instance.path for instance in network.instances}
    for path, seconds in (measured or {}).items():
        if path not in paths:
            raise ArgumentError(f"measured: `{network.top}` has no law or process `{path}`{suggestion(path, paths)}")
        if not 0 <= seconds < 1e9:
            raise ArgumentError(f"measured: the time of `{path}` is a number of seconds, not {seconds!r}")
    return {path: round(seconds * 1e9) for path, seconds in (measured or {}).items()}


def require_states(environment: Environment, point: Mapping[str, float]) -> None:
    """Raise ArgumentError for the name of a state that the plant does not have, and for a value that is not finite."""
    states = () if environment.system is None else tuple(state.name for state in environment.system.states)
    for name, value in point.items():
        if name not in states:
            known = ", ".join(states) or "none"
            raise ArgumentError(f"at: the plant of `{environment.name}` has no state `{name}` (it has: {known})")
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise ArgumentError(f"at: the value of `{name}` is a finite number, not {value!r}")


def definition_to_draw(pictures: Pictures, name: str | None) -> Drawn:
    """The process or environment of that name, or the outermost process. Raises ArgumentError for an unknown name."""
    from cspdiag.network.lower.program import suggestion

    definition = pictures.outermost() if name is None else pictures.named(name)
    if definition is not None:
        return definition
    if name is None:
        raise ArgumentError("there is no process to draw")
    known = (each.name.text for each in pictures.drawn(imported=True))
    raise ArgumentError(f"there is no process or environment `{name}`{suggestion(name, known)}")


def labels_to_hide(pictures: Pictures, definition: Drawn, labels: bool | Iterable[str], depth: int) -> Hidden:
    """The labels to leave out. Raises ArgumentError for one that is not in the picture."""
    from cspdiag.draw.hiding import ALL_LABELS, NOTHING_HIDDEN, hidden

    if isinstance(labels, bool):
        return ALL_LABELS if labels else NOTHING_HIDDEN
    hide = hidden([labels] if isinstance(labels, str) else labels)
    unknown = sorted(hide.names - pictures.labels([definition], depth))
    if unknown:
        raise ArgumentError(f"hide_labels: there is no label `{unknown[0]}` in what is drawn")
    return hide
