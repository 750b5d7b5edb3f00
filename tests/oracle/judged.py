"""cspdiag as a black box: what it answers to a text."""

from __future__ import annotations

import contextlib
import io
import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from cspdiag.cli.main import main


@dataclass
class Output:
    code: int
    out: str
    err: str


def command(*arguments: str) -> Output:
    """One command, in this process, which saves the time of starting one."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(list(arguments))
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
    return Output(int(code or 0), out.getvalue(), err.getvalue())


@dataclass
class Judgement:
    verdict: str  # proved, refuted, unknown, rejected, crashed
    text: str


def verify(text: str, *, seconds: float = 5) -> Judgement:
    """The answer to the only assertion of a program."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "p.csp"
        path.write_text(text)
        output = command("verify", str(path), "--format", "json", "--no-cache", "--time-limit", str(seconds))
    try:
        answers = json.loads(output.out)
    except json.JSONDecodeError:
        return Judgement("crashed", output.out + output.err)
    if not answers or "verdict" not in answers[0]:
        codes = {str(answer.get("code")) for answer in answers if answer.get("severity") == "error"}
        return Judgement("rejected", " ".join(sorted(codes)) + "\n" + json.dumps(answers))
    return Judgement(answers[0]["verdict"], answers[0]["message"])


@dataclass
class RunOutput:
    trace: list[tuple[int, str, object]]
    ending: str
    text: str


def run(text: str, until: str, *options: str) -> RunOutput | None:
    """The trace of one run; None if the program was rejected."""
    with tempfile.TemporaryDirectory() as folder:
        path, trace = Path(folder) / "p.csp", Path(folder) / "t.jsonl"
        path.write_text(text)
        output = command("run", str(path), "--for", until, "--trace", str(trace), *options)
        if not trace.exists():
            return None if re.search(r"error\[E", output.err) else RunOutput([], "crashed", output.err)
        lines = [json.loads(line) for line in trace.read_text().splitlines()]
    made = [(line["t"], line["channel"], line["value"]) for line in lines]
    return RunOutput(made, ending(output.err), output.err)


def ending(summary: str) -> str:
    """How a run ended, from the sentence that says so."""
    for words, name in (("deadlock", "deadlock"), ("time limit", "limit"), ("ended by itself", "terminated")):
        if words in summary:
            return name
    for name in ("Timeout", "Fault"):
        if name in summary:
            return name
    found = re.search(r"\b(E[0-9])\b", summary)
    return found.group(1) if found else summary
