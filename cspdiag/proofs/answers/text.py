"""Answers as text for a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.render.text import render as render_diagnostics
from cspdiag.proofs.answers.answer import MOST_SHOWN, Answer, Outcome
from cspdiag.proofs.answers.findings import diagnostic_of
from cspdiag.proofs.counterexamples.table import table
from cspdiag.proofs.counterexamples.words import waiting_lines

_COLOURS: dict[Outcome, str] = {"proved": "1;32", "refuted": "1;31", "unknown": "1;33"}


def render(answers: Sequence[Answer], *, colour: bool = False, quiet: bool = False) -> str:
    """Each answer with the evidence for it, then the number of answers of each kind; with ``quiet`` only those that are
    not proved.
    """
    shown = [answer for answer in answers if not quiet or answer.outcome != "proved"]
    parts = ["".join(f"{line}\n" for line in _lines(answer, colour)) for answer in shown]
    if not quiet:
        parts.append(f"{summary(answers)}\n")
    return "\n".join(parts)


def summary(answers: Sequence[Answer]) -> str:
    """``3 assertions: 2 proved, 1 refuted in 0.31 s``."""
    counts = Counter(answer.outcome for answer in answers)
    listed = ", ".join(f"{counts[outcome]} {outcome}" for outcome in _COLOURS if counts[outcome])
    singular = "assertion" if all(answer.question.asserted for answer in answers) else "property"
    plural = {"assertion": "assertions", "property": "properties"}[singular] if len(answers) != 1 else singular
    return f"{len(answers)} {plural}: {listed} in {sum(answer.seconds for answer in answers):.2f} s"


def _lines(answer: Answer, colour: bool) -> Iterator[str]:
    verdict = f"{answer.outcome.upper():<8}"
    if colour:
        verdict = f"\x1b[{_COLOURS[answer.outcome]}m{verdict}\x1b[0m"
    yield f"{verdict} {answer.question.text}  ({', '.join(_how(answer))})"
    if answer.outcome == "proved":
        yield f"  {answer.reason}"
        return
    found = diagnostic_of(answer)
    assert found is not None
    drawn = render_diagnostics([found], colour=colour).rstrip("\n").split("\n")
    # The last two lines count diagnostics; here answers are counted.
    yield from drawn[:-2]
    if answer.counterexample is not None:
        yield from _explanation(answer)
    if answer.abstractions and answer.outcome == "unknown":
        yield "  left open in the proof:"
        places = (one.what + ("" if one.span is None else f" ({on_one_line(one.span)})") for one in answer.abstractions)
        lines = list(dict.fromkeys(places))
        yield from (f"    {line}" for line in lines[:MOST_SHOWN])
        if len(lines) > MOST_SHOWN:
            yield f"    and {len(lines) - MOST_SHOWN} more"


def _explanation(answer: Answer) -> Iterator[str]:
    assert answer.counterexample is not None
    steps = table(answer.counterexample)
    if steps:
        yield ""
        yield from (f"  {line}" for line in steps.rstrip("\n").split("\n"))
    waiting = list(waiting_lines(answer.counterexample))
    if waiting:
        yield ""
        yield from (f"  {line}" for line in waiting)
    if answer.replayed:
        yield ""
        yield "  The program itself was stepped through this."


def _how(answer: Answer) -> Iterator[str]:
    if answer.method is not None:
        yield answer.method
    if answer.states is not None:
        yield f"{answer.states} state{'' if answer.states == 1 else 's'}"
    yield f"{answer.seconds:.2f} s"
