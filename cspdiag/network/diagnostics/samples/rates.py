"""What is wrong between processes of different rates."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias, assert_never

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


@record
class FasterLawWaits(Diagnostic):
    code = "W0706"
    title = "faster control law that waits for a slower one"
    severity = "warning"

    law: str
    port: str
    period: int
    sampled: str
    sampled_span: Span
    slower: str
    slower_port: str
    slower_period: int
    slower_span: Span
    is_writer: bool
    """Whether the faster law writes."""

    @property
    def message(self) -> str:
        every, slowly = duration(self.period), duration(self.slower_period)
        if self.is_writer:
            return (
                f"`{self.law}` runs every {every} but waits until `{self.slower}`, which runs every {slowly}, "
                f"takes `{self.port}`: it will miss samples of `{self.sampled}`"
            )
        return (
            f"`{self.law}` runs every {every} but waits for `{self.slower_port}`, which comes every {slowly}: "
            f"it will miss samples of `{self.sampled}`"
        )

    @property
    def help(self) -> str | None:
        if self.is_writer:
            return (
                "let the channel keep the latest value: `overwrite 1` on this relationship, without waiting for the "
                "reader"
            )
        return (
            f"connect a variable to `{self.port}`, and read the slow value into it when it comes: "
            f"`mu (channel ? variable -> skip []> {self.sampled} -> {self.law.rpartition('.')[2]})`"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.sampled_span, f"`{self.law}` takes a sample every {duration(self.period)}"),
            Label(self.slower_span, f"`{self.slower}` takes a sample every {duration(self.slower_period)}"),
        )


Extent: TypeAlias = Literal[
    "two reads", "two reads and a turn", "every turn", "every turn, at most", "some turn", "two turns"
]
"""Where the time passes: between two reads, perhaps with a turn of a loop that reads none; in each turn of a loop that
takes this number of samples, or at most this number; in an iteration that may be taken; in two of them together.
"""


@record
class SamplesMissed(Diagnostic):
    code = "W0707"
    title = "process that misses samples"
    severity = "warning"

    port: str
    period: int
    read: Span
    earlier: Span
    event: str | None
    """The event that is waited for, if any."""
    beside: str | None
    """The event that may come just before the next sample, if any."""
    waits: int
    """The least time that passes, in nanoseconds."""
    slower: str | None
    """The input of which the samples are waited for, in a loop."""
    reads: int
    """How many samples of ``port`` are taken meanwhile, the one that is late included; of a turn of a loop, all."""

    extent: Extent
    is_certain: bool
    """Whether samples are missed, not only if the loop has many turns."""
    is_always: bool
    """Whether every way between the two reads takes that long."""

    @property
    def message(self) -> str:
        every = f"`{self.port}`, which comes every {duration(self.period)}"
        if self.event is not None:
            return f"between two reads of {every}, this {self.meanwhile}: if that takes longer, samples are missed"
        if self.beside is not None:
            return (
                f"between two reads of {every}, this {self.meanwhile}: if that comes late in a period, samples are "
                "missed"
            )
        takes = "takes" if self.is_always else "take"
        taken = "one sample" if self.reads == 1 else f"{self.reads} samples"
        if not self.turns:
            if self.reads == 1:
                return f"between two reads of {every}, this {self.meanwhile}: {self._then}samples are missed"
            return f"this {self.meanwhile} and {takes} {taken} of {every}: {self._then}more are missed"
        match self.extent:
            case "two turns":
                does = f"two iterations of the loop can together {self._wait} and take {taken}"
            case "some turn":
                does = f"an iteration of the loop can {self._wait} and takes {taken}"
            case "two reads" | "two reads and a turn" | "every turn" | "every turn, at most":
                most = "at most " if self.extent == "every turn, at most" else ""
                does = f"each iteration of the loop {self.meanwhile} and takes {most}{taken}"
            case _:
                assert_never(self.extent)
        return f"{does} of {every}: {self._missed}"

    @property
    def turns(self) -> bool:
        """Whether turns of a loop make the process later and later, and not one delay."""
        return not self.extent.startswith("two reads")

    @property
    def meanwhile(self) -> str:
        """What is done between two reads."""
        waits = "waits" if self.is_always or self.turns else "can wait"
        if self.event is not None:
            return f"{waits} for the event `{self.event}`"
        if self.beside is not None:
            return f"{waits} {duration(self.waits)} after the event `{self.beside}`"
        if self.extent == "two reads and a turn":
            return f"{waits} {duration(self.waits)} where an iteration of the loop reads none"
        return f"{waits} {duration(self.waits)}" + ("" if self.slower is None else f" for `{self.slower}`")

    @property
    def _then(self) -> str:
        return "" if self.is_always else "where it does, "

    @property
    def _wait(self) -> str:
        return f"wait {duration(self.waits)}"

    @property
    def account(self) -> str:
        """What one that has missed a sample did meanwhile."""
        if self.extent in ("some turn", "two turns"):
            turns = "an iteration of its loop" if self.extent == "some turn" else "two iterations of its loop"
            samples = "one sample" if self.reads == 1 else f"{self.reads} samples"
            return f"{turns} can {self._wait}, for {samples} of `{self.port}`"
        if self.reads == 1:
            return f"between two reads of `{self.port}` it {self.meanwhile}"
        takes = "takes" if self.is_always or self.turns else "take"
        return f"it {self.meanwhile} and {takes} {self.reads} samples of `{self.port}`"

    @property
    def _missed(self) -> str:
        is_as_long = self.slower is None and self.waits <= self.reads * self.period
        if self.extent in ("some turn", "two turns"):
            misses = "enough such iterations in a row miss samples"
            return f"as soon as anything else takes time, {misses}" if is_as_long else misses
        if is_as_long:
            return "as soon as anything else takes time, samples are missed"
        return "the others are missed" if self.is_certain else "after a few iterations, samples are missed"

    @property
    def help(self) -> str | None:
        if self.slower is not None:
            written = self.alternative
            remedy = "" if written is None else f", `mu ({written})`,"
            return (
                f"let an alternative read whichever comes first{remedy} or a process of its own read the slower one in "
                "parallel"
            )
        own = f"put what reads `{self.port}` into a process of its own, which follows the samples only while it runs"
        if self.event is not None:
            written = self.alternative
            remedy = "" if written is None else f", `{written}`"
            return f"read both in one alternative{remedy}, or {own}"
        return f"count samples of `{self.port}` instead, wait in a process in parallel, or {own}"

    @property
    def alternative(self) -> str | None:
        """What reads whichever comes, in the words of the text; None where these mean something in their place only."""
        other = _guarded(self.slower or self.event or "", self.span)
        read = _guarded(self.port, self.read)
        return None if other is None or read is None else f"{other} []> {read}"

    @property
    def labels(self) -> tuple[Label, ...]:
        if self.read == self.earlier:
            return (Label(self.read, f"reads `{self.port}`"),)
        return (Label(self.earlier, f"reads `{self.port}`"), Label(self.read, f"reads `{self.port}` again"))


def _guarded(port: str, read: Span) -> str | None:
    """A branch that does what reads a port in the text, which is a communication, a guard or a control law; None where
    that is more, or replicated.
    """
    text = read.text
    if text == port or re.fullmatch(rf"{re.escape(port)}\s*\?\s*[\w.]+", text):
        return f"{text} -> ..."
    return f"{port} -> {text}" if re.fullmatch(r"[A-Za-z_]\w*", text) else None
