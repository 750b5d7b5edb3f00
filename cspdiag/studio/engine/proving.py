"""``verify`` and ``timing``: proofs, counterexamples as films, response times."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from cspdiag.obligations import proof_obligations
from cspdiag.proofs.answers.findings import diagnostic_of
from cspdiag.proofs.counterexamples.counterexample import BlockedProcess, Counterexample, Step
from cspdiag.proofs.counterexamples.table import event_text
from cspdiag.proofs.counterexamples.words import headline
from cspdiag.proofs.verdict import Limits
from cspdiag.studio.engine.data import Data, diagnostic_data, place_of
from cspdiag.studio.engine.failure import RequestError
from cspdiag.studio.engine.running import settings
from cspdiag.verify.confirm import Verifier

if TYPE_CHECKING:
    from cspdiag.api import LoadedProgram
    from cspdiag.proofs.answers.answer import Answer
    from cspdiag.proofs.counterexamples.suggestion import Suggestion
    from cspdiag.studio.engine.programs import Files

TIME_LIMIT = 60.0
"""Seconds for each assertion, as for ``cspdiag verify``."""
MEMORY_LIMIT = 1_000_000_000
"""Bytes for states."""
MOST_STEPS = 500
"""At most this number of steps is shown: the first."""
_VERDICTS = {"proved": "holds", "refuted": "fails", "unknown": "unknown"}


def verify(files: Files, params: Data) -> list[Data]:
    """The answers to the assertions of a program, or to the one with the text ``only``; without assertions, whether it
    is free from deadlock and livelock. Raises RequestError for a program with errors.
    """
    only = params.get("only")
    limit = params.get("time_limit", TIME_LIMIT)
    if isinstance(limit, bool) or not isinstance(limit, int | float) or not 0 < limit <= 3600:
        raise RequestError("`time_limit` is a number of seconds, at most 3600")
    obligations = proof_obligations(files.source, files.read)
    if obligations.checked.report.has_errors:
        raise RequestError("the program has errors, so nothing is proved of it", "correct those first")
    questions = [
        each for each in obligations.questions if only is None or only in (each.text, _written(each.span.text))
    ]
    if only is not None and not questions:
        raise RequestError(f"the program asserts no `{only}`")
    obligations.lower(questions)
    problem = obligations.checked.report.first_error
    if problem is not None:
        raise RequestError(problem.message, problem.help)
    verifier = Verifier(obligations, files.read)
    return [_answer(verifier.answer(question, Limits(limit, MEMORY_LIMIT))) for question in questions]


def _written(text: str) -> str:
    return " ".join(text.split())


def _answer(answer: Answer) -> Data:
    found = diagnostic_of(answer)
    suggestions = [_suggestion(each) for each in answer.suggestions]
    return {
        "assertion": answer.question.text,
        "asserted": answer.question.asserted,
        "process": answer.question.process,
        "place": place_of(answer.question.span),
        "verdict": _VERDICTS[answer.outcome],
        "text": answer.reason if found is None else found.words.message,
        "diagnostic": None if found is None else diagnostic_data(found),
        "method": answer.method,
        "states": answer.states,
        "seconds": answer.seconds,
        "candidate": list(answer.candidate),
        "suggestion": suggestions[0] if suggestions else None,
        "suggestions": suggestions,
        "counterexample": None if answer.counterexample is None else _film(answer.counterexample),
    }


def _suggestion(suggestion: Suggestion) -> Data:
    return {
        "title": suggestion.words,
        "proved_with": suggestion.proved_with,
        "edits": [{"place": place_of(suggestion.span), "text": suggestion.replacement}],
    }


def _film(found: Counterexample) -> Data:
    """The steps that people are shown, and which process waits for which in the end."""
    steps = [step for step in found.steps if step.shown]
    return {
        "failure": found.failure,
        "steps": [_step(step, found.process) for step in steps[:MOST_STEPS]],
        "omitted": max(0, len(steps) - MOST_STEPS),
        "cycle": [_step(step, found.process) for step in found.cycle if step.shown],
        "final": {
            "text": headline(found),
            "waiting": [waiting_data(each, found.process) for each in found.waiting],
            "ring": [f"{found.process}.{name}" for name in found.ring],
        },
    }


def _step(step: Step, top: str) -> Data:
    parties = [
        {
            "path": party.path or f"{top}.{party.name}",
            "role": {"!": "writes", "?": "reads"}.get(party.role, party.role),
            "before": party.words,
            "place": None if party.span is None else place_of(party.span),
        }
        for party in step.parties
    ]
    return {
        "kind": step.kind,
        "text": event_text(step, top),
        "channel": None if step.kind == "time" else step.channel or None,
        "value": step.value,
        "writer": _first(parties, "writes"),
        "reader": _first(parties, "reads"),
        "parties": parties,
    }


def _first(parties: Iterable[Data], role: str) -> str | None:
    return next((party["path"] for party in parties if party["role"] == role), None)


def waiting_data(blocked: BlockedProcess, top: str) -> Data:
    """A process that never continues, and for what."""
    return {
        "process": blocked.path or f"{top}.{blocked.name}",
        "for": blocked.words,
        "channels": list(blocked.channels),
        "partners": [f"{top}.{name}" for name in blocked.partners],
        "place": None if blocked.span is None else place_of(blocked.span),
    }


def timing(program: LoadedProgram) -> Data:
    """Response times, latencies and advice. Raises ProgramError."""
    from cspdiag.analyses.timing.report.render_json import as_json
    from cspdiag.analyses.timing.report.render_text import table

    report = program.timing()
    return {"text": table(report), "rows": as_json(report)["loops"], "report": as_json(report)}


def margins(program: LoadedProgram, params: Data) -> Data:
    """Stability and margins of the loops through the plant of an environment. Raises ProgramError, NoEnvironmentError,
    NotLinearError, and ModuleNotFoundError without numpy.
    """
    from cspdiag.analyses.margins.report.render_json import as_json
    from cspdiag.analyses.margins.report.render_text import table

    report = program.margins(params.get("environment"), set=settings(params))
    return {"text": table(report), "report": as_json(report)}
