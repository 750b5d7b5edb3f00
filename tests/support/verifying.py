"""Programs as text, with the answers of ``verify``."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base import Diagnostic, SourceFile
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.counterexamples.table import table
from cspdiag.proofs.counterexamples.words import waiting_lines
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier


class RefusedError(Exception):
    """Nothing is proved of the program; ``found`` says why."""

    def __init__(self, found: Sequence[Diagnostic]) -> None:
        super().__init__(*found)
        self.found = found


def answers_to(files: dict[str, str], main: str = "case.csp", *, process: str | None = None) -> list[Answer]:
    """The answers to the assertions of a program, or to its expected properties. Raises RefusedError."""

    def read(path: str) -> SourceFile:
        if path not in files:
            raise FileNotFoundError(2, "No such file or directory", path)
        return SourceFile(name=path, text=files[path])

    obligations = proof_obligations(read(main), read, process=process)
    report = obligations.checked.report
    obligations.lower()
    if report.has_errors:
        raise RefusedError(report.diagnostics)
    verifier = Verifier(obligations, read)
    return [verifier.answer(question, Limits(60.0)) for question in obligations.questions]


def answer_to(text: str) -> Answer:
    """The answer to the only assertion of a program."""
    (answer,) = answers_to({"case.csp": text})
    return answer


def refuted(text: str) -> bool:
    """Whether the program was stepped through a counterexample; otherwise the answer says why not."""
    answer = answer_to(text)
    assert (answer.outcome, answer.replayed) in {("refuted", True), ("unknown", False)}
    return answer.replayed


def answer_text(answer: Answer) -> str:
    """An answer as in literate cases, without how it was found."""
    head = f"{answer.outcome.upper()} {answer.question.text}"
    if answer.outcome == "proved":
        return f"{head}\n"
    lines = [head]
    if answer.counterexample is not None:
        lines += table(answer.counterexample).splitlines()
        lines += waiting_lines(answer.counterexample)
        lines += ["replayed"] * answer.replayed
    lines += [f"left open: {abstraction.what}" for abstraction in answer.abstractions]
    return "\n  ".join(lines) + "\n"
