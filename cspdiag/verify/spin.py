"""Looks for deadlocks with the model checker SPIN (Holzmann, "The SPIN Model Checker", 2003), if it is installed.

It searches depth first without reduction. ``-DBFS`` is never used: it finds no deadlocks of rendezvous models.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from cspdiag.base.errors import CspdiagError
from cspdiag.codegen.promela.package import Command, commands, promela
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict

_DEPTH = 2_000_000
"""The number of steps of the longest path that is followed."""

_STATES = re.compile(r"^\s*([0-9.e+]+) states, stored", re.MULTILINE)


class SpinError(CspdiagError):
    """SPIN, or the C compiler that it needs, is missing or fails; the message is one line."""


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Freedom from deadlock by SPIN; it does not find knots, and its trace need not be the shortest.

    Raises SpinError.
    """
    for tool in ("spin", "gcc"):
        if shutil.which(tool) is None:
            raise SpinError(f"`{tool}` is not installed (Debian: apt-get install spin gcc)")
    with TemporaryDirectory(prefix="cspdiag-spin-") as folder:
        try:
            text = promela(system)
        except TargetError as problem:
            raise SpinError(str(problem)) from None
        Path(folder, "model.pml").write_text(text, encoding="utf-8")
        try:
            _run(["spin", "-a", "model.pml"], folder, limits)
            memory = max(limits.memory // 1_000_000, 16)
            options = ["-O2", "-w", "-DNOREDUCE", "-DSAFETY", f"-DMEMLIM={memory}"]
            _run(["gcc", *options, "-o", "pan", "pan.c"], folder, limits)
            return _verdict(system, folder, _run(["./pan", "-n", f"-m{_DEPTH}"], folder, limits), limits)
        except LimitError as limit:
            return Unknown("spin", str(limit))


def _run(command: Sequence[str], folder: str, limits: Limits) -> str:
    remaining = limits.remaining
    if remaining <= 0:
        limits.check()
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=remaining, check=False)
    except subprocess.TimeoutExpired:
        raise LimitError(f"the time limit of {limits.seconds:g} s was reached") from None
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines() or [f"exit code {done.returncode}"]
        raise SpinError(f"{command[0]} failed: {said[0]}")
    return done.stdout


def _verdict(system: System, folder: str, said: str, limits: Limits) -> Verdict:
    stored = _STATES.search(said)
    states = None if stored is None else round(float(stored[1]))
    if "invalid end state (at depth" in said:
        trail = _run(["./pan", "-r", f"-m{_DEPTH}"], folder, limits)
        taken = [int(number) for number in re.findall(r"^\s*#(\d+)$", trail, re.MULTILINE)]
        return _refuted(system, commands(system), taken, states)
    if "error: max search depth too small" in said:
        return Unknown("spin", f"a path is longer than {_DEPTH} steps")
    if "Search not completed" in said or "aborting" in said or stored is None:
        return Unknown("spin", f"the memory limit of {limits.memory / 1e6:g} MB was reached")
    looked = "the only state" if states == 1 else f"all {states} states"
    return Proved("spin", f"SPIN looked at {looked} and found no deadlock; it knows no knots", states)


def _refuted(system: System, all_commands: Sequence[Command], taken: Sequence[int], states: int | None) -> Refuted:
    state = list(system.initial)
    trace = []
    for number in taken:
        event, moves = all_commands[number]
        trace.append(Move(event, tuple((component, after) for component, _, after in moves)))
        for component, _, after in moves:
            state[component] = after
    stuck = tuple(
        index
        for index, component in enumerate(system.components)
        if component.process and state[index] not in component.terminal
    )
    return Refuted("spin", tuple(trace), stuck, states=states)
