"""What the models assert is proved, and the errors that they demonstrate are refuted by runs of the program."""

from __future__ import annotations

import pytest

from cspdiag.base.sources import read_source
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier
from tests.models.programs import MODELS

ASSERTING = sorted(
    str(path.relative_to(MODELS))
    for path in MODELS.rglob("*.csp")
    if "\nassert " in path.read_text(encoding="utf-8") and path.stem != "stolen_button"
)


def answers(name: str, change: tuple[str, str] | None = None) -> list[Answer]:
    source = read_source(str(MODELS / name))
    if change is not None:
        assert change[0] in source.text
        source = type(source)(name=source.name, text=source.text.replace(*change))
    obligations = proof_obligations(source, read_source)
    verifier = Verifier(obligations, read_source)
    return [verifier.answer(question, Limits()) for question in obligations.questions]


def test_most_models_assert_something() -> None:
    assert len(ASSERTING) >= 5


@pytest.mark.parametrize("name", ASSERTING)
def test_assertions_of_models_are_proved(name: str) -> None:
    assert [(answer.question.text, answer.outcome) for answer in answers(name) if answer.outcome != "proved"] == []


def test_the_symmetric_table_is_refuted() -> None:
    deadlock, livelock = answers("dining/deadlock.csp")
    assert (deadlock.outcome, deadlock.replayed) == ("refuted", True)
    assert deadlock.counterexample is not None
    assert len(deadlock.counterexample.ring) == 10
    assert livelock.outcome == "proved"


def test_the_stolen_button_is_refuted_and_the_broadcast_one_proved() -> None:
    (stolen,) = answers("jiwy/stolen_button.csp")
    assert (stolen.outcome, stolen.replayed) == ("refuted", True)
    assert stolen.counterexample is not None
    communications = [step.channel for step in stolen.counterexample.steps if step.shown]
    assert communications.index("StolenButton.joystick_buttons") < communications.index("StolenButton.panel.stop")
    assert communications[-2] == "StolenButton.stopped"
    assert communications[-1] in {"StolenButton.joystick_horizontal", "StolenButton.joystick_vertical"}
    added = [step.channel for step in stolen.counterexample.steps if step.added]
    for joint, rounds in (("horizontal", 185), ("vertical", 458)):
        assert added.count(f"StolenButton.feedback_{joint}") == 2 * rounds, "the joint aligns at both ends"
    (shared,) = answers("jiwy/stolen_button.csp", ("-> any ->", "-> broadcast ->"))
    assert shared.outcome == "proved"
