"""Programs as text, with the answers of ``verify``."""

from __future__ import annotations

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.counterexamples.table import table
from cspdiag.proofs.counterexamples.words import waiting_lines
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier


def answers_to(files: dict[str, str], main: str = "case.csp", *, process: str | None = None) -> list[Answer]:
    """The answers to the assertions of a program without errors, or to its expected properties."""

    def read(path: str) -> SourceFile:
        if path not in files:
            raise FileNotFoundError(2, "No such file or directory", path)
        return SourceFile(name=path, text=files[path])

    obligations = pipeline.proof_obligations(read(main), read, process=process)
    assert not obligations.checked.report.has_errors, obligations.checked.report.diagnostics
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
