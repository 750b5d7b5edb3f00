"""Checks and converts the arguments of the Python interface before they are used; the message for a wrong value says
what is expected.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from numbers import Integral, Real
from typing import TYPE_CHECKING

from cspdiag.base import SourceFile
from cspdiag.base.errors import ArgumentError
from cspdiag.base.span import with_line_feeds

if TYPE_CHECKING:
    from cspdiag.draw.elements.communication import Drawn
    from cspdiag.draw.hiding import Hidden
    from cspdiag.draw.pictures import Pictures
    from cspdiag.model.program import Program
    from cspdiag.network.ir.network import Environment, Network
    from cspdiag.runtime.kernel.parameters import Change

LONGEST_LIMIT = 1e6
"""In seconds: no timer of the system needs to wait longer."""

Setting = str | int | float
"""A value as ``cspdiag run --set`` takes it (``"10 ms"``), or a plain number."""


Values = Setting | Iterable[Setting]
"""What a sweep varies: a range or a list as a text (``"1:5:9"``), values, or one value."""


def source_of(text: str, name: str) -> SourceFile:
    """A text as if it had been read from a file. Raises TypeError if it is not a text, ArgumentError for a text that no
    file can hold.
    """
    if not isinstance(text, str):
        raise TypeError(f"the text of a program is a str, not {type(text).__name__}: `load` reads a file")
    require_text("the name of a program", name)
    zero = text.find("\0")
    if zero >= 0:
        raise ArgumentError(f"{name}: not text (a zero byte at offset {zero})")
    try:
        text.encode()
    except UnicodeEncodeError as problem:
        raise ArgumentError(f"{name}: not text (half a character at offset {problem.start})") from None
    return SourceFile(name=name, text=with_line_feeds(text.removeprefix("\ufeff")))


def shown(value: object) -> str:
    """A value as a message shows it; a number with thousands of digits is only described."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:50]}..."


def require_text(what: str, value: object) -> None:
    """Raise TypeError for a value that is not a ``str``."""
    if not isinstance(value, str):
        raise TypeError(f"{what} is a str, not {type(value).__name__}")


def require_names(**names: str | None) -> None:
    """Raise TypeError for a name that is neither a ``str`` nor None."""
    for what, name in names.items():
        if name is not None:
            require_text(what, name)


def require_mapping(what: str, value: object) -> None:
    """Raise TypeError for a value that is not a mapping with text keys."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{what} is a mapping, not {type(value).__name__}")
    for key in value:
        require_text(f"a name in {what}", key)


def number_of(what: str, value: object) -> float:
    """A number of Python or numpy as a float; infinite if it is too large. Raises TypeError for anything else."""
    if not isinstance(value, Real):
        raise TypeError(f"{what} is a number, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        # Only an int or a fraction is too large.
        return math.inf if float(value // abs(value)) > 0 else -math.inf


def settings_of(values: Mapping[str, Setting] | None) -> dict[str, str]:
    """Settings as the language writes them: ``True`` is ``true`` there.

    Raises TypeError for names that are not texts, and for values that are neither texts nor numbers; SettingError for
    numbers that fit no type.
    """
    if values is None:
        return {}
    require_mapping("set", values)
    return {name: _setting(name, value) for name, value in values.items()}


def values_of(values: object) -> dict[str, str | list[str]]:
    """The values of a sweep by name: texts as they are, sequences of settings as the language writes them. Raises
    TypeError and SettingError as ``settings_of`` does.
    """
    if not isinstance(values, Mapping):
        raise TypeError(f"set is a mapping, not {type(values).__name__}")
    require_mapping("set", values)
    found: dict[str, str | list[str]] = {}
    for name, given in values.items():
        if isinstance(given, str) or not isinstance(given, Iterable):
            found[name] = given if isinstance(given, str) else [_setting(name, given)]
        else:
            found[name] = [_setting(name, value) for value in given]
    return found


def _setting(name: str, value: Setting) -> str:
    from cspdiag.settings import SettingError, WrittenNumber

    if isinstance(value, str):
        return value
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):
        return str(value).lower()
    number = number_of(f"the value of {name}", value)
    if isinstance(value, Integral):
        if not math.isfinite(number):
            raise SettingError(f"{name}: {shown(value)} is larger than any number of the language")
        return WrittenNumber(int(value))
    # A binary32 keeps the few digits it was written with.
    return WrittenNumber(value if isinstance(value, float) else str(value))


def changes_of(program: Program, tune: object) -> list[Change]:
    """The changes of parameters that a mapping from times to settings describes. Raises TypeError and SettingError."""
    from cspdiag.tuning import parse_change

    if not isinstance(tune, Mapping):
        raise TypeError(f"tune is a mapping from times to settings, or a Tuning, not {type(tune).__name__}")
    return [
        parse_change(program, time_limit(time), name, value)
        for time, settings in tune.items()
        for name, value in settings_of(settings).items()
    ]


def time_limit(until: str | float) -> int:
    """How long a run lasts at most, in nanoseconds. Raises TypeError for a value that is neither a text nor a number,
    SettingError for one that is not a time.
    """
    from cspdiag.settings import SettingError, parse_time_limit

    if isinstance(until, str):
        return parse_time_limit(until)
    seconds = number_of("until", until)
    if isinstance(until, bool) or not math.isfinite(seconds):
        raise SettingError(f"`{shown(until)} s` is not a time: write a number of seconds, or a text such as '20 s'")
    return parse_time_limit(f"{seconds!r} s")


def require_one_of(what: str, value: object, known: Collection[object]) -> None:
    """Raise ArgumentError for a value that is not among the known ones."""
    if value not in known:
        raise ArgumentError(f"unknown {what} {shown(value)} (there are: {', '.join(map(str, known))})")


def require_seconds(what: str, seconds: float) -> float:
    """The seconds as a float. Raises TypeError for a value that is not a number, ArgumentError for one that is not
    positive or longer than a timer of the system can wait.
    """
    number = number_of(what, seconds)
    if not 0 < number <= LONGEST_LIMIT:
        raise ArgumentError(f"{what} is a positive number of seconds up to {LONGEST_LIMIT:g}, not {shown(seconds)}")
    return number


def measured_times(network: Network, measured: Mapping[str, float] | None) -> dict[str, int]:
    """Execution times in nanoseconds, from seconds by path. Raises TypeError for a value that is not a mapping to
    numbers, ArgumentError for an unknown path or an impossible time.
    """
    from cspdiag.network.lower.program import suggestion

    if measured is None:
        return {}
    require_mapping("measured", measured)
    paths = {instance.path for instance in network.instances}
    for path in measured:
        if path not in paths:
            raise ArgumentError(f"measured: `{network.top}` has no law or process `{path}`{suggestion(path, paths)}")
    return {path: execution_time(f"measured: the time of `{path}`", seconds) for path, seconds in measured.items()}


def execution_time(what: str, seconds: float) -> int:
    """An execution time in nanoseconds. Raises TypeError for a value that is not a number, ArgumentError for an
    impossible time.
    """
    if not 0 <= number_of(what, seconds) < 1e9:
        raise ArgumentError(f"{what} is a number of seconds, not {shown(seconds)}")
    return round(float(seconds) * 1e9)


def require_states(environment: Environment, point: Mapping[str, float]) -> None:
    """Raise TypeError for a value that is not a mapping to numbers, ArgumentError for the name of a state that the
    plant does not have, and for a value that is not finite.
    """
    require_mapping("at", point)
    states = () if environment.system is None else tuple(state.name for state in environment.system.states)
    for name, value in point.items():
        if name not in states:
            known = ", ".join(states) or "none"
            raise ArgumentError(f"at: the plant of `{environment.name}` has no state `{name}` (it has: {known})")
        if not math.isfinite(number_of(f"the value of `{name}`", value)):
            raise ArgumentError(f"at: the value of `{name}` is a finite number, not {shown(value)}")


def definition_to_draw(pictures: Pictures, name: str | None) -> Drawn:
    """The process or environment of that name, or the outermost process. Raises SelectionError if there is none."""
    from cspdiag.network.lower.program import SelectionError, suggestion

    definition = pictures.outermost() if name is None else pictures.named(name)
    if definition is not None:
        return definition
    if name is None:
        raise SelectionError("there is no process to draw")
    known = (each.name.text for each in pictures.drawn(imported=True))
    raise SelectionError(f"there is no process or environment `{name}`{suggestion(name, known)}")


def labels_to_hide(pictures: Pictures, definition: Drawn, labels: bool | Iterable[str], depth: int) -> Hidden:
    """The labels to leave out. Raises ArgumentError for one that is not in the picture."""
    from cspdiag.draw.hiding import ALL_LABELS, NOTHING_HIDDEN, hidden

    if isinstance(labels, bool):
        return ALL_LABELS if labels else NOTHING_HIDDEN
    names = [labels] if isinstance(labels, str) else list(labels)
    for name in names:
        require_text("a label to hide", name)
    hide = hidden(names)
    unknown = sorted(hide.names - pictures.labels([definition], depth))
    if unknown:
        raise ArgumentError(f"hide_labels: there is no label `{unknown[0]}` in what is drawn")
    return hide


def require_level(level: object, known: str = "0 or 1") -> None:
    """ArgumentError for another level of optimization than 0 and 1; ``known`` is what the message offers."""
    if level not in (0, 1):
        raise ArgumentError(f"there is no optimization level {shown(level)}: choose {known}")


def require_way_to_run(level: object, target: str, *, real_time: bool) -> None:
    """ArgumentError for an unknown level or target, and for one that the reference semantics does not have."""
    if level != "reference":
        require_level(level, "0, 1 or 'reference'")
        if target not in ("python", "c", "auto"):
            raise ArgumentError(f"the target {shown(target)} cannot be run: choose 'python', 'c' or 'auto'")
    elif target != "python" or real_time:
        raise ArgumentError(
            "the reference semantics is not a target, and has virtual time only: omit `target` and `real_time`"
        )


def require_depth(depth: object) -> None:
    """Raises TypeError for a depth of a picture that is no whole number, ArgumentError for one below 1."""
    if not isinstance(depth, int):
        raise TypeError(f"depth is an int, not {type(depth).__name__}")
    if depth < 1:
        raise ArgumentError(f"depth is at least 1, not {shown(depth)}")
