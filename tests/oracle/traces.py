"""The trace of one program: that of every target compared with the one run of the page."""

from __future__ import annotations

from tests.oracle.judged import RunOutput, run
from tests.oracle.page_run import page_run
from tests.oracle.programs.text import duration, shown, text
from tests.oracle.programs.tree import Program

Trace = list[tuple[int, str, object]]
TARGETS: dict[str, tuple[str, ...]] = {
    "-O0": ("-O0",),
    "-O1": ("-O1",),
    "C": ("--target", "c", "-O0"),
    "C -O1": ("--target", "c", "-O1"),
}


def by_channel(trace: Trace) -> dict[str, list[tuple[int, object]]]:
    found: dict[str, list[tuple[int, object]]] = {}
    for time, channel, value in trace:
        found.setdefault(channel, []).append((time, value))
    return found


def difference(expected: Trace, given: Trace, external: set[str]) -> str:
    """Where two traces differ: in the values of one channel, or in the order of the external ports."""
    one, other = by_channel(expected), by_channel(given)
    for channel in sorted(one.keys() | other.keys()):
        here, there = one.get(channel, []), other.get(channel, [])
        if here != there:
            at = next(
                (i for i, (a, b) in enumerate(zip(here, there, strict=False)) if a != b), min(len(here), len(there))
            )
            return f"{channel}, communication {at + 1}: {there[at : at + 2]} instead of {here[at : at + 2]}"
    ours = [each for each in expected if each[1] in external]
    theirs = [each for each in given if each[1] in external]
    return "" if ours == theirs else f"the order of the external ports: {theirs} instead of {ours}"


def compare_traces(program: Program, until: int, targets: tuple[str, ...]) -> tuple[list[str], str]:
    """The outcome to count, and the first difference."""
    expected = page_run(program, until)
    if expected.ending == "too long":
        return ["too large"], ""
    kinds = {channel.name: channel.type for channel in program.channels} | {
        port.name: port.type for port in program.ports
    }
    trace: Trace = [(time, channel, shown(value, kinds[channel])) for time, channel, value in expected.trace]
    external = {port.name for port in program.ports}
    counted = ["five communications"] if len(trace) >= 5 else []
    for target in targets:
        output = run(text(program), duration(until), *TARGETS[target])
        if output is None:
            return ["rejected"], ""
        wrong = _wrong(trace, expected.ending, output, external)
        if wrong:
            return counted, f"{target}: {wrong}\n// the run of the page: {trace}, {expected.ending}"
    return counted, ""


def _wrong(trace: Trace, ending: str, output: RunOutput, external: set[str]) -> str:
    if output.ending == "crashed":
        return "cspdiag fails: " + output.text
    given = [(time, channel.rpartition(".")[2], value) for time, channel, value in output.trace]
    wrong = difference(trace, given, external)
    if not wrong and output.ending != ending:
        wrong = f"ends with {output.ending} instead of {ending}"
    return wrong
