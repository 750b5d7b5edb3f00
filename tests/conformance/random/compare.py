"""One program on all targets, and a smaller one that differs in the same way."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NoReturn

from cspdiag.base import SourceFile
from tests.conformance.kit import external_channels
from tests.conformance.random.changes import changes_in
from tests.conformance.random.nodes import Program
from tests.conformance.sources import JUST_AFTER, InvalidProgramError, network_of
from tests.conformance.targets import REFERENCE, TARGETS
from tests.conformance.traces import compare
from tests.support.alarm import alarm_after

LIMIT = 60_000_000 + JUST_AFTER
LONGEST = 180
"""Seconds after which a run on one target is taken to hang."""
LEAST = 5
"""Programs with fewer communications are not counted."""

NATIVE = ("c-O0", "c-O1", "c-O0-steps")
SANITIZED = "-fsanitize=address,undefined -fno-sanitize-recover=all"


class HangError(Exception):
    """A target did not finish."""


def communications(text: str) -> int | None:
    """The number of communications on the reference; None for a program with errors."""
    try:
        network = network_of(SourceFile(name="random.csp", text=text))
    except InvalidProgramError:
        return None
    with changes_in(text):
        return len(REFERENCE.run(network, None, LIMIT).trace)


def difference(text: str, names: Sequence[str], compiler: str | None = None, *, sanitized: bool = False) -> str:
    """The first target that behaves differently from the reference, and how; empty if all behave the same."""
    network = network_of(SourceFile(name="random.csp", text=text))
    with changes_in(text):
        expected = REFERENCE.run(network, None, LIMIT)
    for name in names:
        label = name if compiler is None else f"{name} ({compiler}{', sanitized' * sanitized})"
        try:
            with _within(LONGEST), changes_in(text), _environment(CC=compiler, CFLAGS=SANITIZED if sanitized else None):
                done = TARGETS[name].run(network, None, LIMIT)
        except Exception as crash:
            return f"{label} fails with {type(crash).__name__}: {str(crash)[:2000]}"
        found = compare(expected.trace, done.trace, external_channels(network))
        if found is not None:
            return f"{label} differs\n{found}"
        if not expected.ending.agrees_with(done.ending):
            return f"{label} ends otherwise\n  {expected.ending}\n  {done.ending}"
        if done.released is not None and done.released != expected.released:
            return f"{label} releases otherwise\n  {expected.released}\n  {done.released}"
    return ""


def smallest(
    program: Program,
    reported: str,
    names: Sequence[str],
    compiler: str | None,
    seconds: float,
    *,
    sanitized: bool = False,
) -> tuple[Program, str]:
    """The smallest program found within ``seconds`` that differs in the same way as was ``reported`` for ``program``,
    and how it differs.

    A program whose difference cannot be reproduced is returned unchanged.
    """
    until = time.monotonic() + seconds
    way, found_smaller = reported.partition("\n")[0], True
    while found_smaller:
        found_smaller = False
        for other in program.smaller():
            if time.monotonic() > until:
                return program, reported
            try:
                found = difference(str(other), names, compiler, sanitized=sanitized)
            except InvalidProgramError:
                continue
            if found.partition("\n")[0] == way:
                program, reported, found_smaller = other, found, True
                break
    return program, reported


@contextmanager
def _within(seconds: int) -> Iterator[None]:
    def late() -> NoReturn:
        raise HangError(f"no end after {seconds} s")

    with alarm_after(seconds, late):
        yield


@contextmanager
def _environment(**values: str | None) -> Iterator[None]:
    kept = {name: os.environ.get(name) for name in values}
    _set(values)
    try:
        yield
    finally:
        _set(kept)


def _set(values: dict[str, str | None]) -> None:
    for name, value in values.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
