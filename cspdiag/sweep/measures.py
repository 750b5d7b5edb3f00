"""What is measured in a run: texts such as ``max(abs(pan.angle))``, as numbers of signals."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Literal

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record
from cspdiag.base.spelling import Speller
from cspdiag.codegen.c.package.sweep import states_of
from cspdiag.simulate.record.leaves import Path, leaves

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.network.ir.network import CoreNetwork, Environment

KINDS = ("max", "min", "peak", "mean", "rms", "last", "integral", "settling", "overshoot")
"""In the order of the enumeration in ``csp_sweep.h``."""

_TARGETS = {"settling": ("TARGET", "TOLERANCE"), "overshoot": ("TARGET",)}
"""What some take besides the signal."""

_CALL = re.compile(r"\s*(?P<kind>\w+)\s*\((?P<inside>.*)\)\s*", re.DOTALL)
_ABSOLUTE = re.compile(r"\s*abs\s*\((?P<inside>[^()]*)\)\s*")


class MeasureError(CspdiagError, ValueError):
    """A measure cannot be computed of this program; the message is one line."""


@record
class Signal:
    """A number that changes during a run: a port of the program or a part of it, or a state of the environment.

    ``number`` is its position among the external ports, or among the states; ``whole`` is the type of the port or the
    state, and ``path`` leads to the number in it.
    """

    name: str
    source: Literal["port", "state"]
    number: int
    whole: Type
    path: Path
    type: Type


@record
class Measure:
    """What is measured of a signal, or of its distance to a second one; ``unit`` is empty for a plain number."""

    text: str
    kind: str
    signal: int
    subtracted: int | None
    absolute: bool
    target: float
    tolerance: float
    unit: str


@record
class Measures:
    """The measures of a sweep, and the signals to which they refer by position."""

    signals: tuple[Signal, ...]
    measures: tuple[Measure, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """What each is called in tables."""
        return tuple(measure.text for measure in self.measures)


def parse_measures(texts: Iterable[str], network: CoreNetwork, environment: Environment | None) -> Measures:
    """The measures. Raises MeasureError."""
    known = signals_of(network, environment)
    used: dict[str, int] = {}
    found: dict[str, Measure] = {}
    for text in texts:
        measure = _measure(text, known, used)
        if found.setdefault(measure.text, measure) != measure:
            raise MeasureError(f"{measure.text} is measured twice")
    return Measures(tuple(known[name] for name in used), tuple(found.values()))


def signals_of(network: CoreNetwork, environment: Environment | None) -> dict[str, Signal]:
    """What can be measured, by name. A port has precedence over a state of the same name."""
    from cspdiag.model.types import TextType

    found: dict[str, Signal] = {}
    sources: list[tuple[Literal["port", "state"], list[tuple[str, Type]]]] = [
        ("port", [(port.key, port.type) for port in network.external_ports]),
        ("state", [(state.name, state.type) for state in states_of(environment)]),
    ]
    for source, items in sources:
        for number, (name, whole) in enumerate(items):
            for part, type_, path in leaves(name, whole):
                if not isinstance(type_, TextType):
                    found.setdefault(part, Signal(part, source, number, whole, path, type_))
    return found


def _measure(text: str, known: dict[str, Signal], used: dict[str, int]) -> Measure:
    call = _CALL.fullmatch(text)
    if call is None:
        raise MeasureError(f"a measure is {_forms()}, not {text!r}")
    kind = call["kind"]
    if kind not in KINDS:
        near = Speller().nearest(kind, KINDS)
        meant = f"did you mean `{near}`?" if near else f"there are {_forms()}"
        raise MeasureError(f"there is no measure {kind!r} ({meant})")
    argument, *others = (part.strip() for part in call["inside"].split(","))
    wanted = _TARGETS.get(kind, ())
    if len(others) != len(wanted):
        raise MeasureError(f"{text.strip()}: it is {_form(kind)}")
    absolute = _ABSOLUTE.fullmatch(argument)
    names = [name.strip() for name in (absolute["inside"] if absolute else argument).split("-")]
    if len(names) > 2 or not all(names):
        raise MeasureError(f"{text.strip()}: of a signal, or of a difference of two: {kind}(NAME - NAME)")
    signals = [_signal(name, known) for name in names]
    if len({_quantity(signal.type) for signal in signals}) > 1:
        both = " and ".join(f"{signal.name} ({signal.type})" for signal in signals)
        raise MeasureError(f"{text.strip()}: {both} have no difference, because their units are not the same")
    numbers = [_target(text, part, signals[0].type) for part in others]
    if len(numbers) > 1 and numbers[1] < 0:
        raise MeasureError(f"{text.strip()}: a tolerance is not negative")
    places = [used.setdefault(signal.name, len(used)) for signal in signals]
    inside = " - ".join(names)
    shown = ", ".join([f"abs({inside})" if absolute else inside, *others])
    return Measure(
        text=f"{kind}({shown})",
        kind=kind,
        signal=places[0],
        subtracted=places[1] if len(places) > 1 else None,
        absolute=absolute is not None,
        target=numbers[0] if numbers else 0.0,
        tolerance=numbers[1] if len(numbers) > 1 else 0.0,
        unit=_unit(kind, signals[0].type),
    )


def _forms() -> str:
    return f"{', '.join(map(_form, KINDS[:-1]))} or {_form(KINDS[-1])}"


def _form(kind: str) -> str:
    return f"{kind}({', '.join(('SIGNAL', *_TARGETS.get(kind, ())))})"


def _signal(name: str, known: dict[str, Signal]) -> Signal:
    from cspdiag.network.lower.program import suggestion

    name = "".join(name.split())
    if name not in known:
        raise MeasureError(f"there is no port or state {name!r} to measure{suggestion(name, known)}")
    return known[name]


def _quantity(type_: Type) -> object:
    """What the numbers of a type can be compared with: those of a unit, times, or other numbers."""
    from cspdiag.model.types import RealType, TimeType

    if isinstance(type_, RealType):
        return type_.unit
    return "time" if isinstance(type_, TimeType) else "number"


def _target(text: str, part: str, type_: Type) -> float:
    from cspdiag.model.constants.values import parse_value
    from cspdiag.model.types import DOUBLE, TimeType

    number_type = DOUBLE if isinstance(_quantity(type_), str) and not isinstance(type_, TimeType) else type_
    try:
        value = parse_value(number_type, part)
    except ValueError as problem:
        raise MeasureError(f"{text.strip()}: {problem}") from None
    assert isinstance(value, int | float)
    return value / 1e9 if isinstance(type_, TimeType) else float(value)


def _unit(kind: str, type_: Type) -> str:
    from cspdiag.model.types import RealType, TimeType

    if kind == "settling":
        return "s"
    own = type_.unit.text if isinstance(type_, RealType) else "s" if isinstance(type_, TimeType) else ""
    if kind != "integral":
        return own
    return f"{own}*s" if own else "s"


def measured(measures: Measures, observations: Sequence[tuple[int, int, float]], end: int) -> tuple[float | None, ...]:
    """The values, of a run that ended at ``end`` nanoseconds; None if nothing was observed, it did not settle, or the
    result is not a number.

    ``observations`` are instants in nanoseconds, positions of signals, and values, in order. The same operations, in
    the same order, as in ``csp_sweep_measures.c``.
    """
    values: list[float | None] = [None] * len(measures.signals)
    meters = [Meter(measure) for measure in measures.measures]
    users: list[list[Meter]] = [[] for _ in measures.signals]
    for meter in meters:
        users[meter.measure.signal].append(meter)
        if meter.measure.subtracted is not None and meter.measure.subtracted != meter.measure.signal:
            users[meter.measure.subtracted].append(meter)
    present, changed = 0, dict[int, Meter]()

    def close_instant() -> None:
        for meter in changed.values():
            meter.update(present, values)
        changed.clear()

    for time, signal, value in observations:
        if time != present:
            close_instant()
            present = time
        values[signal] = value
        changed.update((id(meter), meter) for meter in users[signal])
    close_instant()
    return tuple(meter.result(end) for meter in meters)


class Meter:
    """Computes one measure while values arrive."""

    def __init__(self, measure: Measure) -> None:
        self.measure = measure
        self._since: int | None = None
        self._first = 0
        self._value = 0.0
        self._result = 0.0
        self._begun: float | None = None

    def update(self, now: int, values: Sequence[float | None]) -> None:
        """Take the values that the signals have after everything at an instant."""
        measure = self.measure
        value = values[measure.signal]
        if value is None:
            return
        if measure.subtracted is not None:
            other = values[measure.subtracted]
            if other is None:
                return
            value -= other
        self._take(now, abs(value) if measure.absolute else value)

    def _take(self, now: int, value: float) -> None:
        kind = self.measure.kind
        if self._since is None:
            self._first = now
            self._begun = value if kind == "overshoot" else None
            self._result = {"max": value, "min": value, "peak": abs(value)}.get(kind, 0.0)
        else:
            self._hold(now)
        self._since, self._value = now, value
        match kind:
            case "max":
                self._result = max(self._result, value)
            case "min":
                self._result = min(self._result, value)
            case "peak":
                self._result = max(self._result, abs(value))
            case "last":
                self._result = value
            case "settling":
                if not abs(value - self.measure.target) <= self.measure.tolerance:
                    self._begun = None
                elif self._begun is None:
                    self._begun = now / 1e9
            case "overshoot":
                self._result = max(self._result, self._beyond(value))
            case _:  # Integrals are taken when it is known how long a value was held.
                pass

    def _beyond(self, value: float) -> float:
        target, begun = self.measure.target, self._begun
        assert begun is not None
        if begun < target:
            return value - target
        return target - value if begun > target else abs(value - target)

    def _hold(self, now: int) -> None:
        assert self._since is not None
        held = (now - self._since) / 1e9
        if held <= 0:
            return  # Not a NaN where the value, or its square, is infinite.
        if self.measure.kind in ("mean", "integral"):
            self._result += self._value * held
        elif self.measure.kind == "rms":
            self._result += (self._value * self._value) * held

    def result(self, end: int) -> float | None:
        """The measure of a run that ended at ``end`` nanoseconds; None if it is not a number."""
        from math import isnan

        if self._since is None:
            return None
        self._hold(end)
        result = self._of_whole_run(end)
        return None if result is None or isnan(result) else result

    def _of_whole_run(self, end: int) -> float | None:
        from math import sqrt

        length = (end - self._first) / 1e9
        match self.measure.kind:
            case "mean":
                return self._result / length if length > 0 else self._value
            case "rms":
                return sqrt(self._result / length) if length > 0 else abs(self._value)
            case "settling":
                return self._begun
            case _:  # The others are known at any time.
                return self._result
