"""Literate cases: Markdown files whose sections contain a program and what the compiler says about it.

Each ``##`` section is a case: prose, a fenced ``csp`` block with the program, further ``csp NAME`` blocks with the
files it imports, then a ``diagnostics`` block (``diagnostics float32`` with ``--real float32``, ``diagnostics
no-numpy`` without numpy), a ``network`` block or both, or a ``composition`` block: the elements of the composition
diagrams. ``network -O1`` is the network after all passes of the optimizer, ``network specialize,variables`` the network
after these passes, ``network flatten.Main`` only its class ``Main``.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cspdiag import pipeline
from cspdiag.base import Diagnostic, SourceFile, Span
from cspdiag.model.types import Real
from cspdiag.proofs.answers.findings import diagnostics_of
from tests.support.lacking import without_numpy
from tests.support.verifying import RefusedError, answer_text, answers_to

CASES = Path(__file__).parent / "cases"
MAIN = "case.csp"

_FENCE = re.compile(r"^```(?P<language>\w+)(?: +(?P<name>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block: its text is from ``start`` to ``end`` in the file."""

    language: str
    name: str | None
    text: str
    start: int
    end: int


@dataclass(frozen=True)
class Case:
    """A section of a literate file."""

    path: Path
    title: str
    line: int
    blocks: tuple[Block, ...]

    @property
    def files(self) -> dict[str, str]:
        """The programs of the case by file name; the one without a name is ``case.csp``."""
        return {block.name or MAIN: block.text for block in self.blocks if block.language == "csp"}

    @property
    def expectations(self) -> tuple[Block, ...]:
        return tuple(
            block for block in self.blocks if block.language in {"diagnostics", "network", "composition", "proofs"}
        )


def cases_of(path: Path) -> Iterator[Case]:
    """The cases of one Markdown file."""
    text = path.read_text(encoding="utf-8")
    blocks = [Block(m["language"], m["name"], m["text"], m.start("text"), m.end("text")) for m in _FENCE.finditer(text)]
    inside = [(block.start, block.end) for block in blocks]
    heads = [
        head
        for head in re.finditer(r"^## +(.+)$", text, re.MULTILINE)
        if not any(start <= head.start() < end for start, end in inside)
    ]
    for head, following in zip(heads, [*[h.start() for h in heads[1:]], len(text)], strict=True):
        own = tuple(block for block in blocks if head.start() < block.start < following)
        yield Case(path, head[1].strip(), text.count("\n", 0, head.start()) + 1, own)


def all_cases() -> list[Case]:
    return [case for path in sorted(CASES.rglob("*.md")) for case in cases_of(path)]


def check_files(files: dict[str, str], real: Real = "double") -> pipeline.Checked:
    """Check the program ``case.csp``, with imports from ``files``."""

    def read(path: str) -> SourceFile:
        if path not in files:
            raise FileNotFoundError(2, "No such file or directory", path)
        return SourceFile(name=path, text=files[path])

    return pipeline.check(read(MAIN), read, real=real)


def _place(span: Span) -> str:
    place = f"{span.line}:{span.column}"
    return place if span.file == MAIN else f"{span.file}:{place}"


def describe(diagnostics: list[Diagnostic]) -> str:
    """Diagnostics in the form of a ``diagnostics`` block."""
    lines = []
    for diagnostic in diagnostics:
        lines.append(f"{_place(diagnostic.span)} {diagnostic.severity}[{diagnostic.code}] {diagnostic.message}")
        if diagnostic.help is not None:
            first, *rest = diagnostic.help.splitlines()
            lines += [f"  help: {first}", *(f"    {line}" for line in rest)]
        lines += [f"  note {_place(label.span)} {label.message}" for label in diagnostic.labels]
    return "".join(f"{line}\n" for line in lines)


def actual(case: Case, block: Block) -> str:
    """What the compiler says now for ``block``."""
    if block.language == "proofs":
        try:
            answers = answers_to(case.files, MAIN)
        except RefusedError as problem:
            return describe(problem.found)
        return "".join(f"{answer_text(answer)}{describe(diagnostics_of([answer]))}" for answer in answers)
    with without_numpy() if block.name == "no-numpy" else contextlib.nullcontext():
        checked = check_files(case.files, "float32" if block.name == "float32" else "double")
    if block.language == "diagnostics":
        return describe(checked.report.diagnostics)
    if block.language == "composition":
        return _compositions(checked)
    network = pipeline.compile_network(checked)
    if network is None:
        return describe(checked.report.diagnostics)
    from cspdiag.network.dump.network import dump
    from cspdiag.optimize import PASSES, optimize, pass_named

    passes, _, cls = (block.name or "").partition(".")
    if passes:
        chosen = PASSES if passes == "-O1" else [pass_named(name) for name in passes.split(",")]
        network = optimize(network, chosen, debug=True)
    text = dump(network)
    return text if not cls else _class_alone(text, cls)


def _compositions(checked: pipeline.Checked) -> str:
    """The elements of the composition diagrams, with or without errors."""
    from cspdiag.draw.elements.composition import outline
    from cspdiag.draw.elements.read_composition import composition_diagram
    from cspdiag.syntax import ast

    assert checked.readable is not None
    definitions = checked.readable.definitions
    processes = [each for each in definitions.values() if isinstance(each, ast.ProcessDefinition)]
    return "".join(outline(composition_diagram(definitions, each)) for each in processes if each.composition)


def _class_alone(listing: str, name: str) -> str:
    """The lines of one class of a network."""
    found = re.search(rf"^(///.*\n)*(process|submodel) {re.escape(name)}\b.*?^}}", listing, re.MULTILINE | re.DOTALL)
    assert found is not None, f"there is no class {name}"
    return f"{found[0]}\n"


def update(path: Path) -> None:
    """Rewrite every expected block of a literate file with what the compiler says now."""
    text = path.read_text(encoding="utf-8")
    replacements = []
    for case in cases_of(path):
        for block in case.expectations:
            # A case for which the compiler fails keeps its block, and its own test shows the traceback.
            with contextlib.suppress(Exception):
                replacements.append((block, actual(case, block)))
    for block, found in sorted(replacements, key=lambda pair: pair[0].start, reverse=True):
        text = text[: block.start] + found + text[block.end :]
    path.write_text(text, encoding="utf-8")
