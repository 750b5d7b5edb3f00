"""Counterexamples as JSON, and traces to replay."""

from __future__ import annotations

from typing import Any

from cspdiag.base.render.json import place
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Party, Step
from cspdiag.proofs.counterexamples.rounds import Repeated, repeated


def encoded(found: Counterexample) -> dict[str, Any]:
    """Everything about a counterexample, in types of JSON; lines and columns count from 1."""
    return {
        "failure": found.failure,
        "reason": found.reason,
        "steps": [entry for part in repeated(found.steps) for entry in _steps(part)],
        "cycle": [_step(step) for step in found.cycle],
        "waiting": [
            {
                "process": entry.name,
                "path": entry.path,
                "waits": entry.words,
                "channels": list(entry.channels),
                "for": list(entry.partners),
                "ended": list(entry.ended),
                **place(entry.span),
            }
            for entry in found.waiting
        ],
        "ring": list(found.ring),
    }


def _steps(part: Repeated) -> list[dict[str, Any]]:
    """The steps, or one entry for all iterations of a loop."""
    steps = [_step(step) for step in part.steps]
    if not part.steps[0].added:
        return steps
    return [{"kind": "rounds", "channel": "", "value": None, "parties": [], "times": part.times, "steps": steps}]


def _step(step: Step) -> dict[str, Any]:
    return {
        "kind": step.kind,
        "channel": step.channel,
        "value": step.value,
        "parties": [_party(party) for party in step.parties],
    }


def _party(party: Party) -> dict[str, Any]:
    return {"process": party.name, "path": party.path, "before": party.words, **place(party.span)}
