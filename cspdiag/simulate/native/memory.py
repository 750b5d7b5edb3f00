"""The memory that a program in C needs, as its compiler lays it out for the target machine."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from graphlib import CycleError, TopologicalSorter

from cspdiag.base.files.json_text import read_json
from cspdiag.base.record import record
from cspdiag.codegen.c.package.layouts import OWNERS
from cspdiag.codegen.c.package.linkage import NAMES, NO_NAMES
from cspdiag.codegen.c.package.sizes import PREFIX, SizeMeasurement, Sizes
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.build import Build, CompilerError

_PROBE = "sizes_probe.c"
_INDIRECT = "__indirect_call"
_SHOWN_FRAMES = 5
_PATIENCE = 20
"""Seconds of processor time after which a compiler is stopped: the package is written without the report, and a message
says so.
"""


@record
class FunctionFacts:
    """A compiler's data on a function: the bytes of its frame and the functions that it calls; None if unknown.

    ``grows``: arrays of variable length, or ``alloca``, need more.
    """

    stack: int
    calls: tuple[str, ...] | None
    grows: bool = False


@record
class FileFacts:
    """A compiler's data on a file: bytes of variables by name, and its functions by name."""

    variables: Mapping[str, int]
    functions: Mapping[str, FunctionFacts]


@record
class MemoryReport:
    """The bytes of a program: ``outside`` for variables besides the memory of an instance, ``stack`` for the deepest
    stack.

    ``exact`` says whether the calls of all functions were known, so the stack is a bound and not an estimate.
    ``unbounded`` says why there is no bound, as "deep calls itself"; empty: there is one.
    """

    compiler: str
    sizes: Sizes
    outside: int
    stack: int
    exact: bool
    unbounded: str
    frames: tuple[tuple[str, int], ...]
    """The functions with the largest frames, largest first: names, as in the sources, and bytes."""

    @property
    def text(self) -> str:
        """The report as lines of text: what an instance has, the memory for it, and what there is besides."""
        rows = [f"memory, as {self.compiler} lays it out:"]
        entries: list[tuple[str, int, int]] = []
        for item in self.sizes.classes:
            entries.append((f"{item.kind} {item.name}", item.count, item.bytes))
        frames = [f"frame of {name}" for name, _ in self.frames]
        sizes = self.sizes
        parts = sum(count * size for _, count, size in entries) + sizes.channel_bytes
        rest, memory = f"unused of {sizes.memory_name}", f"instance, {sizes.memory_name}"
        widths = [len(name) for name, _, _ in entries] + [len(name) - 17 for name in frames] + [len(rest) - 19]
        name_width = max(*widths, len("channels"))

        def row(name: str, size: int) -> str:
            return f"  {name:<{name_width + 19}} {_bytes(size):>11}"

        for name, count, size in entries:
            rows.append(f"  {name:<{name_width}} {count:>7} x {size:>6} = {_bytes(count * size):>11}")
        rows.append(f"  {'channels':<{name_width}} {sizes.channels:>7}          = {_bytes(sizes.channel_bytes):>11}")
        rows.append(row("ports, kernel and hooks", max(sizes.instance - parts, 0)))
        rows += [row(rest, sizes.memory - sizes.instance), row(memory, sizes.memory)]
        rows += [row("variables outside of it", self.outside)] if self.outside else []
        bound = "about" if not self.exact else "at least" if self.unbounded else "at most"
        rows.append(row(f"stack, {bound}", self.stack))
        rows += [f"    {self.unbounded}"] if self.unbounded else []
        rows += [
            f"    {frame:<{name_width + 17}} {_bytes(size):>11}"
            for frame, (_, size) in zip(frames, self.frames, strict=True)
        ]
        rows.append(row("total", sizes.memory + self.outside + self.stack))
        return "\n".join(rows)


def _bytes(count: int) -> str:
    return f"{count} bytes" if count < 100_000 else f"{count / 1000:.0f} kB"


def memory_report(network: CoreNetwork, files: Mapping[str, str], level: int) -> MemoryReport:
    """Compile a generated package to measure it. Raises CompilerError."""
    measurement = SizeMeasurement(network, level)
    names = next(
        (path for path in files if path.endswith(f"/{NAMES.rpartition('/')[2]}")), NAMES
    )  # A framework has it elsewhere.
    complete = {**files, names: NO_NAMES, _PROBE: measurement.source()}
    sources = [path for path in complete if path.endswith(".c") and not _is_of_simulation(path)]
    build = Build(complete, sources, ("-O2", "-DCSP_TRACE=0"))
    with ThreadPoolExecutor() as pool:
        facts = dict(zip(sources, pool.map(lambda path: _facts(build, path), sources), strict=True))
    probed = facts.pop(_PROBE).variables
    sizes = measurement.sizes(
        {name.removeprefix(PREFIX): size for name, size in probed.items() if name.startswith(PREFIX)}
    )
    functions = {name: function for file in facts.values() for name, function in file.functions.items()}
    exact = all(function.calls is not None for function in functions.values())
    stack = deepest(functions) if exact else _estimated(functions)
    instantiated = [file for path, file in facts.items() if not path.endswith(OWNERS)]
    outside = sum(size for file in instantiated for size in file.variables.values())
    frames = _largest_frames(functions)
    return MemoryReport(build.compiler.version, sizes, outside, stack, exact, unbounded(functions), frames)


def _is_of_simulation(path: str) -> bool:
    """Whether a file belongs to the simulation, and not to the program."""
    stem = path.rpartition("/")[2]
    host_files = (
        "main_",
        "csp_linear",
        "csp_port_",
        "csp_signals",
        "csp_simulation",
        "csp_steering",
        "csp_stream",
        "csp_tuning",
        "csp_watch",
    )
    return stem.startswith(host_files) or stem.endswith("_environment.c")


def _facts(build: Build, path: str) -> FileFacts:
    """The data on one file, from the cache if it was measured before."""
    place = build.cache / "facts" / f"{build.digest(path)}.json"
    try:
        found = read_json(place.read_text(encoding="utf-8"))
        functions = {
            name: FunctionFacts(stack, None if calls is None else tuple(calls), grows)
            for name, (stack, calls, grows) in found["functions"].items()
        }
        return FileFacts(found["variables"], functions)
    except (OSError, ValueError, KeyError):
        pass
    made = build.assembled(path, ("-fstack-usage", "-fcallgraph-info=su"), ("-fstack-usage",), (), patience=_PATIENCE)
    facts = FileFacts(dict(_variables(made["s"])), _functions(made))
    kept = {
        "variables": dict(facts.variables),
        "functions": {
            name: (function.stack, function.calls, function.grows) for name, function in facts.functions.items()
        },
    }
    build.keep_text(json.dumps(kept), place)
    return facts


def _variables(assembly: str) -> Iterator[tuple[str, int]]:
    """The variables of a file with their sizes; constants need no memory of the program."""
    constant = True
    objects: set[str] = set()
    for row in assembly.splitlines():
        text = row.strip()
        if found := re.match(r"\.(?:comm|lcomm|zerofill\s+\S+?,\S+?,)\s*_?([\w.$]+),\s*(\d+)", text):
            yield found[1], int(found[2])
        elif text.startswith((".data", ".bss")):
            constant = False
        elif text.startswith((".text", ".section")):
            constant = not re.search(r"\.(data|bss)(?!\.rel\.ro)", text)
        elif found := re.match(r"\.type\s+([\w.$]+),\s*[@%]object", text):
            objects.add(found[1])
        elif (found := re.match(r"\.size\s+([\w.$]+),\s*(\d+)", text)) and found[1] in objects and not constant:
            yield found[1], int(found[2])


def _functions(made: Mapping[str, str]) -> dict[str, FunctionFacts]:
    """Frames from the list of stack usage, and calls from the call graph if the compiler writes one."""
    frames = {}
    growing = set()
    for row in made.get("su", "").splitlines():
        place, size, kind = row.split("\t")
        name = place.rpartition(":")[2]
        frames[name] = int(size)
        growing |= {name} if kind == "dynamic" else set()
    if "ci" not in made:
        return {name: FunctionFacts(size, None, name in growing) for name, size in frames.items()}
    calls: dict[str, list[str]] = {name: [] for name in frames}
    for source, target in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', made["ci"]):
        calls.setdefault(source.rpartition(":")[2], []).append(target.rpartition(":")[2])
    return {name: FunctionFacts(frames.get(name, 0), tuple(called), name in growing) for name, called in calls.items()}


def deepest(functions: Mapping[str, FunctionFacts]) -> int:
    """The greatest sum of frames along calls. A call through a pointer may reach any function that is never called by
    name.

    There is no recursion except through pointers; what is called through one is a step, a driver or a report, which
    ends before the next one.
    """
    called = {name for function in functions.values() for name in function.calls or ()}
    pointed = [name for name in functions if name not in called]
    known: dict[str, int] = {}

    def depth(name: str, indirect: bool) -> int:
        key = f"{name} {indirect}"
        if key not in known:
            known[key] = 0
            function = functions.get(name)
            if function is not None:
                below = [depth(other, indirect) for other in function.calls or () if other != _INDIRECT]
                if indirect and _INDIRECT in (function.calls or ()):
                    below += [depth(other, False) for other in pointed]
                known[key] = function.stack + max(below, default=0)
        return known[key]

    return max((depth(name, True) for name in pointed), default=0)


def unbounded(functions: Mapping[str, FunctionFacts]) -> str:
    """Why the stack has no bound: what calls itself, directly or through others, or has arrays of variable length."""
    for name, function in sorted(functions.items()):
        if function.grows:
            return f"{name} has an array of variable length, or calls alloca"
    calls = TopologicalSorter({name: function.calls or () for name, function in functions.items()})
    try:
        calls.prepare()
    except CycleError as found:
        return f"{min(found.args[1])} calls itself, directly or through others"
    return ""


def _largest_frames(functions: Mapping[str, FunctionFacts]) -> tuple[tuple[str, int], ...]:
    frames = sorted(((-function.stack, name) for name, function in functions.items()))
    return tuple((name, -size) for size, name in frames[:_SHOWN_FRAMES])


def _estimated(functions: Mapping[str, FunctionFacts]) -> int:
    """An estimate if calls are not known: the sum of the eight largest frames."""
    return sum(sorted((function.stack for function in functions.values()), reverse=True)[:8])


def report_or_reason(network: CoreNetwork, files: Mapping[str, str], level: int) -> str:
    """The report, or the reason why it cannot be made."""
    try:
        return memory_report(network, files, level).text
    except CompilerError as problem:
        return f"memory: not known, {problem}"
