"""Whether a run does what its specification forbids, if the specification knows only the range of a value."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.transitions.classes.distinguished import AsSpecification
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.replay.refinement import judge
from cspdiag.verify.replay.rest import Resting
from cspdiag.verify.systems import SystemCache
from tests.support.verifying import answers_to

TEXT = """process Lights(least: int) {
  in  pressed : int
  out lamp    : bool

  communication { var code : int = 0 }

  composition { mu (pressed ? code ; if code >= least then lamp ! true) }
}

process Has {
  in  pressed : int
  out lamp    : bool

  communication {
    lights : Lights(least = 3)

    pressed     -> lights.pressed
    lights.lamp -> lamp
  }

  composition { lights }
}

process Demands {
  in  pressed : int
  out lamp    : bool

  communication {
    lights : Lights(least = 2)

    pressed     -> lights.pressed
    lights.lamp -> lamp
  }

  composition { lights }
}

assert Has refines Demands
"""


@pytest.mark.parametrize(
    ("run", "says"),
    [
        ([("pressed", 7), ("lamp", True), ("pressed", -1), ("pressed", 1)], None),
        ([("pressed", 7), ("pressed", 1)], "it does `pressed.1`, where the specification allows only `lamp.true`"),
        ([("pressed", 1), ("lamp", True)], "it does `lamp.true`, where the specification allows only"),
    ],
)
def test_run(run: list[tuple[str, object]], says: str | None) -> None:
    obligations = proof_obligations(SourceFile(name="case.csp", text=TEXT), read_source)
    (question,) = obligations.questions
    network = obligations.network("Has")
    assert network is not None
    judged = judge(
        question, lambda apart: SystemCache(obligations).of("Demands", apart, AsSpecification()), network, Limits()
    )
    reported = judged([(f"Has.{port}", value) for port, value in run], Resting((), can_continue=True))
    assert (reported is None) == (says is None)
    assert (reported or "").startswith(says or "")


HIDES_AN_ARRAY = """process Two {
  out lamp[2] : bool
  out late    : bool

  composition { (lamp[0] ! true || lamp[1] ! true) ; late ! true ; late ! false }
}

process Once {
  out late : bool

  composition { late ! true }
}

assert Two refines Once hide lamp
"""


def test_elements_of_hidden_ports_are_hidden() -> None:
    """They may occur in another order than they were found in."""
    (answer,) = answers_to({"case.csp": HIDES_AN_ARRAY})
    assert (answer.outcome, answer.replayed) == ("refuted", True), answer.reason
