"""Tier 0: design rules. Networks that obey one cannot deadlock, and the rule gives the reason in words.

Two general rules are checked: that of the only run (``rules.runs``) and that of orders of waiting
(``structure.waiting``). If the processes have the form that a published rule requires, the reason names that rule.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.model.wording import counted
from cspdiag.proofs.rules import forms as rules_forms
from cspdiag.proofs.rules.runs import PeriodicRun, at_rest, first_unsteady, moves_of, only_run
from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict

MOST_MOVES = 1_000_000
"""A run that has not returned to a known state after this number of moves is left to other methods."""

MOST_NAMES = 6
"""At most this number of components of an order is named; of a longer one only the first and the last."""


def by_rules(question: StuckQuestion, limits: Limits) -> Verdict:
    """Proves the property by a design rule, refutes it by the only run, or says which process breaks the rules."""
    try:
        if is_settled(question):
            return Proved("rules", _order_in_words(question))
        chooses = first_unsteady(question.structure)
        if chooses is not None:
            name = question.system.components[chooses].name
            return Unknown("rules", f"`{name}` has an alternative, and processes may wait for each other in a circle")
        if question.structure.fails and not question.together:
            return Unknown(
                "rules",
                "a missed sample or a fault may end the wait of those who seem stuck, which the only run does not show",
            )
        run = question.structure.cached("run", lambda: only_run(question.structure, limits, MOST_MOVES))
        if run is None:
            return Unknown(
                "rules", f"the only run has not returned to an earlier state within {MOST_MOVES} communications"
            )
        return _judged(question, run)
    except LimitError as limit:
        return Unknown("rules", str(limit))


def is_settled(question: StuckQuestion) -> bool:
    """Whether the orders of waiting alone exclude that any process is stuck."""
    shapes, left = question.structure.shapes, question.waiting.left
    if not question.together:
        return all(states.isdisjoint(shape.requesting) for shape, states in zip(shapes, left, strict=True))
    if not all(left):
        return True
    return not any(shape.process and not states <= shape.terminal for shape, states in zip(shapes, left, strict=True))


def _judged(question: StuckQuestion, run: PeriodicRun) -> Verdict:
    components = question.system.components
    stuck: Sequence[int] = ()
    if question.together:
        if not run.period:
            stuck = [at for at, part in enumerate(components) if part.process and run.state[at] not in part.terminal]
    elif any(run.state[at] in question.structure.shapes[at].requesting for at in at_rest(question.structure, run)):
        stuck = OffersByState(question.system).knot(run.state)
    if stuck:
        return Refuted("rules", moves_of(question.structure, run), tuple(stuck))
    if rules_forms.is_io_par(question.structure):
        return Proved(
            "rules", "in each round every process communicates once with each partner, in any order: an I/O-PAR network"
        )
    steps = counted(len(run.taken), "step")
    does = f"repeats itself after {steps}" if run.period else f"ends, as do all processes, after {steps}"
    return Proved("rules", f"no process has a choice, and the only run {does}")


def _order_in_words(question: StuckQuestion) -> str:
    structure = question.structure
    if not any(structure.neighbours):
        return "no process ever waits for another"
    order = [at for at in question.waiting.order if structure.neighbours[at]]
    settled = set(order)
    if any(
        shape.requesting and at not in settled for at, shape in enumerate(structure.shapes) if structure.neighbours[at]
    ):
        processes = [at for at in question.waiting.order if structure.shapes[at].process]
        if question.together and processes:
            return f"{_names(question, processes)} can always continue"
        return "no process waits in a circle with others"
    if not order:
        return "no process ever waits for another"
    taken = rules_forms.resource_order(structure)
    if taken is not None:
        return f"every process takes its resources in one order{_listed(question, taken)}"
    servers = rules_forms.client_server_order(structure)
    if servers is not None:
        return f"a client-server network without circles{_listed(question, servers)}"
    return f"each process waits only for those before it, in the order{_listed(question, order)}"


def _listed(question: StuckQuestion, order: Sequence[int]) -> str:
    return f": {_names(question, order)}" if order else ""


def _names(question: StuckQuestion, order: Sequence[int]) -> str:
    names = [f"`{question.system.components[at].name}`" for at in order]
    if len(names) > MOST_NAMES:
        names = [*names[: MOST_NAMES - 2], f"… ({len(names)} in all)", names[-1]]
    return ", ".join(names)
