"""cspdiag as a black box: its answer for a text."""

from __future__ import annotations

import contextlib
import io
import json
import re
import subprocess
import sys
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
    """Run a command in this process, which saves the time of starting one."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(list(arguments))
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
    return Output(int(code or 0), out.getvalue(), err.getvalue())


def alone(*arguments: str) -> Output:
    """Run a command in a process of its own, which is killed if it takes longer than a minute: native runs may hang."""
    with subprocess.Popen(
        [sys.executable, "-m", "cspdiag", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        try:
            out, err = child.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            child.kill()
            raise
    return Output(child.returncode, out, err)


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
        arguments = ("run", str(path), "--for", until, "--trace", str(trace), *options)
        try:
            output = alone(*arguments) if "c" in options else command(*arguments)
        except subprocess.TimeoutExpired:
            return RunOutput([], "crashed", "does not end within a minute")
        if not trace.exists():
            return None if re.search(r"error\[E", output.err) else RunOutput([], "crashed", output.err)
        lines = [json.loads(line) for line in trace.read_text().splitlines()]
    made = [(line["t"], line["channel"], line["value"]) for line in lines]
    return RunOutput(made, ending(output.err), output.err)


def ending(summary: str) -> str:
    """How a run ended, according to the sentence that reports it."""
    raised = re.search(r"ended unsuccessfully at [^:]*: (\w+)", summary)
    if raised:
        return raised.group(1)
    for words, name in (("deadlock", "deadlock"), ("time limit", "limit"), ("ended by itself", "terminated")):
        if words in summary:
            return name
    return summary
