"""The diagnostics of the timing analysis: loops that are late, and loops without a known bound."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class NotSchedulable(Diagnostic):
    code = "E1106"
    title = "a loop that is late"

    process: str
    reason: str
    loops: tuple[tuple[str, str, str, Span], ...]
    """Name, period, worst response time in words, and place of each loop that may be late."""
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.process}` is not schedulable: {self.reason}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(
            Label(place, f"`{name}` has {period} and may take {response}")
            for name, period, response, place in self.loops[:4]
        )


@record
class NoTimingBound(Diagnostic):
    code = "E1107"
    title = "not known to be in time"

    process: str
    reason: str
    places: tuple[tuple[str, Span], ...]
    """The reasons in words, with their places."""
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"it is not known whether `{self.process}` is schedulable: {self.reason}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, words) for words, place in self.places[:6])
