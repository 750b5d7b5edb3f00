"""The answer to ``assert P schedulable``."""

from __future__ import annotations

import time

from cspdiag.analyses.timing.report.diagnostics import diagnostic_of
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.analyses.timing.result import TimingReport
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.answers.answer import Answer, Outcome
from cspdiag.proofs.answers.question import Question


def schedulable(question: Question, network: CoreNetwork) -> Answer:
    """Proved if every sampled loop is ready before its next sample; unknown if the time that a loop takes has
    no bound.
    """
    began = time.monotonic()
    report = timing_report(network)
    return answer_of(question, report, time.monotonic() - began)


def answer_of(question: Question, report: TimingReport, seconds: float) -> Answer:
    """The answer from a timing report, which took this number of seconds to make."""
    outcomes: dict[bool | None, Outcome] = {True: "proved", False: "refuted", None: "unknown"}
    found = diagnostic_of(report, question.span)
    return Answer(question, outcomes[report.is_schedulable], None, report.reason, seconds, found=found)
