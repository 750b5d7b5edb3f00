"""Every verb on four networks of 10 to 100,000 instances, written as one line each and as an array.

``scale.py measure costs.json`` runs the commands, each in a process of its own with limits of time and memory, and
writes what they cost. ``scale.py page costs.json`` writes that into ``docs/scale.md`` and ``docs/images/scale.svg``.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from arrays import text_of

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "scale.md"
PICTURE = ROOT / "docs" / "images" / "scale.svg"
NETWORKS = ("ring", "pipeline", "workers", "star")
FORMS = ("lines", "array")
COUNTS = (10, 100, 1_000, 10_000, 100_000)
COUNTED = "var question : int\n    var served   : int = 0\n  }\n\n  composition {\n    (mu) ((alt"
"""The beginning of the server of a star that ends."""

MEMORY = 8 << 30
"""The bytes of address space of a command."""

STEPS = {
    "check": ("check",),
    "fmt": ("fmt", "--diff"),
    "compile -O0": ("compile", "--force", "-O0"),
    "compile -O1": ("compile", "--force", "-O1"),
    "C -O0": ("compile", "--force", "--target", "c", "-O0"),
    "C -O1": ("compile", "--force", "--target", "c", "-O1"),
    "run -O0": ("run", "-O0", "--quiet"),
    "run -O1": ("run", "-O1", "--quiet"),
    "draw": ("draw",),
    "verify": ("verify", "--no-cache"),
    "verify asserted": ("verify", "--no-cache"),
}
COLOURS = (
    "#4269d0",
    "#9498a0",
    "#efb118",
    "#ff725c",
    "#6cc5b0",
    "#3ca951",
    "#ff8ab7",
    "#a463f2",
    "#97bbf5",
    "#9c6b4e",
    "#1f1f1f",
)


class Row(NamedTuple):
    """The cost of one command in seconds of processor time and bytes of memory, with that of its child processes.

    ``end`` is "", "time" if it was stopped, "memory" if it had too little, or "refused" for another failure.
    """

    step: str
    network: str
    form: str
    instances: int
    seconds: float
    memory: int
    end: str


def source(network: str, form: str, count: int, *, ends: bool) -> str:
    """The program. With ``ends``, every process ends after a few rounds."""
    text = text_of(network, count)
    if ends:
        text = text.replace("const rounds = 100", "const rounds = 2")
        text = text.replace("var question : int\n  }\n\n  composition {\n    mu (alt", COUNTED)
        text = text.replace("% 1000 + i)\n", "% 1000 + i) ; served := served + 1) until served == 3 * size\n")
        text = text if network == "ring" else text.replace(" mu ", " seq k < 3 : ")
    text = text.replace("(mu) (", "mu (")
    return text if form == "array" else _with_lines(network, count, text)


def _with_lines(network: str, count: int, text: str) -> str:
    """The same program, with a line for each instance and each relationship of the outermost process."""
    match network:
        case "ring":
            cells = [f"cell{i}" for i in range(count - 1)]
            instances = ["head : Head", *(f"{cell} : Cell" for cell in cells)]
            around = ["head", *cells, "head"]
            relations = [f"{one}.output -> {next_one}.input" for one, next_one in pairwise(around)]
            steps = ["(head", f"({cells[0]}", *cells[1:-1], f"{cells[-1]})) catch Finished -> skip"]
        case "pipeline":
            stages = [f"stage{i}" for i in range(count)]
            instances = ["source : Source", *(f"{stage} : Stage(gain = {i})" for i, stage in enumerate(stages))]
            instances.append("sink : Sink")
            around = ["source", *stages, "sink"]
            relations = [f"{one}.output -> {next_one}.input" for one, next_one in pairwise(around)]
            steps = ["source", f"({stages[0]}", *stages[1:-1], f"{stages[-1]})", "sink"]
        case "workers":
            instances = [f"{kind}{i} : {kind.capitalize()}" for kind in ("worker", "server") for i in range(count)]
            steps = [f"(worker{i} || server{i})" for i in range(count)]
            relations = [f"worker{i}.request -> server{i}.request" for i in range(count)]
            relations += [f"server{i}.reply -> worker{i}.reply" for i in range(count)]
        case _:
            steps = ["server", "(client0", *(f"client{i}" for i in range(1, count - 1)), f"client{count - 1})"]
            instances = ["server : Server", *(f"client{i} : Client" for i in range(count))]
            relations = [f"client{i}.request -> server.request[{i}]" for i in range(count)]
            relations += [f"server.reply[{i}] -> client{i}.reply" for i in range(count)]
    head, _, last = text.rpartition("\nprocess ")
    name = last.partition(" ")[0]
    declared = "\n".join(f"    {line}" for line in [*instances, "", *relations]).replace("    \n", "\n")
    composed = "\n    || ".join(steps)
    return (
        f"{head}\nprocess {name} {{\n  communication {{\n{declared}\n  }}\n\n"
        f"  composition {{\n    {composed}\n  }}\n}}\n"
    )


def cost(step: str, network: str, form: str, count: int, limit: int) -> Row:
    """Run one command, which is stopped after ``limit`` seconds on the clock."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, f"{network}.csp")
        text = source(network, form, count, ends=step.startswith("run"))
        if step == "verify asserted":
            outermost = text.rpartition("\nprocess ")[2].partition(" ")[0]
            text += f"\nassert {outermost} deadlock free\n"
        program.write_text(text, encoding="utf-8")
        output = {"compile": ("-o", "made"), "C": ("-o", "made"), "draw": ("-o", "drawn.svg")}.get(step.split()[0], ())
        limited = f"import resource, runpy; resource.setrlimit(resource.RLIMIT_AS, ({MEMORY}, {MEMORY})); "
        command = [sys.executable, "-c", f"{limited}runpy.run_module('cspdiag', run_name='__main__', alter_sys=True)"]
        running = subprocess.Popen(
            [*command, *STEPS[step], str(program), *output],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, cwd=folder, start_new_session=True, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        ended_by = ""

        def stop(*_: object) -> None:
            nonlocal ended_by
            ended_by = "time"
            os.killpg(running.pid, signal.SIGKILL)

        signal.signal(signal.SIGALRM, stop)
        signal.alarm(limit)
        assert running.stderr is not None
        said = running.stderr.read()
        _, status, used = os.wait4(running.pid, 0)
        signal.alarm(0)
        running.returncode = os.waitstatus_to_exitcode(status)
    expected = (0, 1) if step.split()[0] in ("verify", "fmt") else (0,)
    if not ended_by and running.returncode not in expected:
        ended_by = "memory" if "Memory" in said or running.returncode < 0 else "refused"
    return Row(step, network, form, count, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024, ended_by)


def measure(given: argparse.Namespace) -> None:
    """Run the commands, larger counts until one has to be stopped, and add what they cost to the file."""
    place = Path(given.costs)
    rows = read(place) if place.exists() else []
    for step in given.step or STEPS:
        for network in given.network or NETWORKS:
            for form in given.form or FORMS:
                for count in given.count or COUNTS:
                    rows = [row for row in rows if row[:4] != (step, network, form, count)]
                    rows.append(cost(step, network, form, count, given.limit))
                    print(*rows[-1], flush=True)
                    place.write_text(json.dumps(rows), encoding="utf-8")
                    if rows[-1].end:
                        break


def read(place: Path) -> list[Row]:
    """What the commands cost, as ``measure`` has written it."""
    return [Row(*row) for row in json.loads(place.read_text(encoding="utf-8"))]


def page(given: argparse.Namespace) -> None:
    """Write the table and the picture."""
    rows = read(Path(given.costs))
    text = PAGE.read_text(encoding="utf-8")
    before, mark, rest = text.partition("<!-- costs -->\n")
    _, end, after = rest.partition("<!-- end of costs -->")
    assert mark
    assert end
    PAGE.write_text(before + mark + "\n".join(table(rows)) + "\n" + end + after, encoding="utf-8")
    PICTURE.write_text("\n".join(picture(rows)) + "\n", encoding="utf-8")


def table(rows: Sequence[Row]) -> Iterator[str]:
    """A table in Markdown: a line for each command and network, with the counts as columns."""
    known = {row[:4]: row for row in rows}
    for form in FORMS:
        yield f"\n### {'One line for each instance' if form == 'lines' else 'An array of instances'}\n"
        yield "| command | network | " + " | ".join(f"{count:,}" for count in COUNTS) + " |"
        yield "| --- | --- |" + " ---: |" * len(COUNTS)
        for step in STEPS:
            for network in NETWORKS:
                found = [known.get((step, network, form, count)) for count in COUNTS]
                if any(found):
                    yield f"| `{step}` | {network} | " + " | ".join(map(_cell, found)) + " |"
    yield ""


def _cell(row: Row | None) -> str:
    if row is None:
        return ""
    match row.end:
        case "":
            return f"{row.seconds:.3g} s, {row.memory / 1e6:.0f} MB"
        case "time":
            return "stopped"
        case other:
            return other


WIDTH, HEIGHT, LEFT, TOP = 250, 260, 46, 26


def picture(rows: Sequence[Row]) -> Iterator[str]:
    """Processor time of each verb for a ring, both axes logarithmic; a grey line grows as ``n`` does."""
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * (WIDTH + LEFT) + 120} {HEIGHT + TOP + 30}" '
        'font-family="sans-serif" font-size="10">'
    )
    yield '<rect width="100%" height="100%" fill="white"/>'
    for number, form in enumerate(FORMS):
        yield f'<g transform="translate({LEFT + number * (WIDTH + LEFT)} {TOP})">'
        yield f'<text x="{WIDTH / 2}" y="-10" text-anchor="middle">ring, {form}</text>'
        yield from _axes()
        for step, colour in zip(STEPS, COLOURS, strict=True):
            found = sorted(row for row in rows if row[:3] == (step, "ring", form) and not row.end)
            points = " ".join(f"{_x(row.instances):.1f},{_y(row.seconds):.1f}" for row in found)
            if points:
                yield f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.5"/>'
        yield "</g>"
    for number, (step, colour) in enumerate(zip(STEPS, COLOURS, strict=True)):
        x, y = 2 * (WIDTH + LEFT) + 20, TOP + 14 + 16 * number
        yield f'<path d="M{x} {y}h16" stroke="{colour}" stroke-width="2"/><text x="{x + 22}" y="{y + 3}">{step}</text>'
    yield "</svg>"


def _axes() -> Iterator[str]:
    for count in COUNTS:
        yield f'<path d="M{_x(count):.1f} 0V{HEIGHT}" stroke="#ddd"/>'
        yield f'<text x="{_x(count):.1f}" y="{HEIGHT + 14}" text-anchor="middle">{count:,}</text>'
    for seconds in (0.1, 1, 10, 100):
        yield f'<path d="M0 {_y(seconds):.1f}H{WIDTH}" stroke="#ddd"/>'
        yield f'<text x="-5" y="{_y(seconds) + 3:.1f}" text-anchor="end">{seconds:g} s</text>'
    linear = f"M{_x(1_000):.1f} {_y(0.3):.1f}L{_x(100_000):.1f} {_y(30):.1f}"
    yield f'<path d="{linear}" stroke="#999" stroke-dasharray="3"/>'


def _x(count: int) -> float:
    return WIDTH * (math.log10(count) - 1) / 4


def _y(seconds: float) -> float:
    return HEIGHT * (1 - (math.log10(max(seconds, 0.03)) + 1.5) / 3.7)


def main() -> None:
    """Measure, or write the page."""
    parser = argparse.ArgumentParser(prog="scale.py")
    commands = parser.add_subparsers(required=True)
    measuring = commands.add_parser("measure")
    measuring.set_defaults(run=measure)
    measuring.add_argument("costs")
    measuring.add_argument("--limit", type=int, default=120, help="seconds for each command (default: 120)")
    measuring.add_argument("--count", type=int, action="append")
    for name, choices in (("network", NETWORKS), ("form", FORMS), ("step", tuple(STEPS))):
        measuring.add_argument(f"--{name}", choices=choices, action="append")
    writing = commands.add_parser("page")
    writing.set_defaults(run=page)
    writing.add_argument("costs")
    given = parser.parse_args()
    given.run(given)


if __name__ == "__main__":
    main()
