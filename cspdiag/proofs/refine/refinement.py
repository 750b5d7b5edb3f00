"""Refinement: whether a process does only what a specification does, in traces and in stable failures (Roscoe,
"Understanding Concurrent Systems", sections 5.1 and 6.4).

The specification in normal form is added to the process as one more component, which takes part in every event that it
sees, and goes to a state of its own if an event is not allowed. So the search is the same as for deadlocks, and finds a
shortest trace. The passage of time, and steps of a process that the specification does not see, count as internal: only
a state without such steps can refuse anything.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cspdiag.base.record import replaced
from cspdiag.proofs.properties.livelock import livelock_free
from cspdiag.proofs.reduce.reduction import is_large, seen_from_outside
from cspdiag.proofs.refine.labels import END, Label, Labels, is_open
from cspdiag.proofs.refine.normal_form import NormalNode, normal_form
from cspdiag.proofs.refine.words import ended_too_soon, forbidden_event, forbidden_refusal
from cspdiag.proofs.search.breadth_first import Exploration, explore, trace_to
from cspdiag.proofs.search.packed_conditions import Deadlocks
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.search.traces import end_of
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System
from cspdiag.proofs.verdict import ONE_REACHABLE, LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict, counted


def refines_in_traces(system: System, specification: System, limits: Limits, hidden: Collection[str] = ()) -> Verdict:
    """Whether every trace of the process is a trace of the specification, which does not see ``hidden`` ports."""
    return _refines(system, specification, limits, hidden, failures=False)


def refines_in_failures(system: System, specification: System, limits: Limits, hidden: Collection[str] = ()) -> Verdict:
    """Whether in addition the process refuses, in its stable states, only what the specification may refuse there."""
    return _refines(system, specification, limits, hidden, failures=True)


def _refines(
    system: System, specification: System, limits: Limits, hidden: Collection[str], *, failures: bool
) -> Verdict:
    labels = Labels(specification, hidden)
    system = _up_to_missed_samples(system)
    answer: Verdict | None = None
    try:
        specification = _made_small(specification, labels, limits)
        answer = _of_outside(system, specification, labels, limits, failures=failures) if is_large(system) else None
        if isinstance(answer, Proved):
            return answer
        search, seen, nodes = _searched(system, specification, labels, limits, failures=failures)
    except LimitError as stop:
        found = (
            f"there is a violation, but no trace to it was found: {answer.reason}; "
            if isinstance(answer, Refuted)
            else ""
        )
        return Unknown("breadth-first", f"{found}{stop}")
    if search.found is not None:
        return _violation(search, seen, nodes, system)
    if (undecided := _undecided(nodes, labels)) is not None:
        return Unknown("breadth-first", undecided)
    model = "stable failure" if failures else "trace"
    where = ONE_REACHABLE if search.states == 1 else f"the {search.states} reachable states"
    reason = f"every {model} in {where} is one of the specification"
    return Proved("breadth-first", reason + _caveat(specification, limits, failures), search.states)


def _up_to_missed_samples(system: System) -> System:
    """The process with a divergence after each missed sample that no process catches: it neither ends nor refuses
    anything there, so a proof is about its runs up to that point.
    """
    components = tuple(
        replaced(
            component,
            edges=tuple(
                ((INTERNAL, state),) if state in component.failed else edges
                for state, edges in enumerate(component.edges)
            ),
            terminal=component.terminal - component.failed,
        )
        if component.failed
        else component
        for component in system.components
    )
    return replaced(system, components=components)


def _undecided(nodes: tuple[NormalNode, ...], labels: Labels) -> str | None:
    """The reason why it is not known what the specification allows; None if it is known. If it may write any of several
    values that it has read, their representatives do not show which.

    If it writes at most one value at a time, they do: if a run of the process whose inputs are all different writes a
    wrong value, then the run with the representative in place of that value, and with other values elsewhere, takes the
    same steps in the process and in the specification (Lazic and Roscoe, "Data independence with predicate symbols",
    1999).
    """
    for node in nodes:
        written: dict[str, list[Label]] = {}
        for label in node.offered:
            if label[0] not in labels.specification.distinctions:
                written.setdefault(label[0], []).append(label)
        for name, found in written.items():
            if len(found) > 1 and any(map(is_open, found)):
                return f"which of several values the specification writes to `{name}` is not followed"
    return None


def _made_small(specification: System, labels: Labels, limits: Limits) -> System:
    """The specification, or an equivalent one with fewer states."""
    if not is_large(specification):
        return specification
    kept = [number for number, event in enumerate(specification.events) if labels.of(event) is not None]
    return seen_from_outside(specification, kept, limits) or specification


def _of_outside(
    system: System, specification: System, labels: Labels, limits: Limits, *, failures: bool
) -> Proved | Refuted | None:
    """The answer for a smaller system that is equivalent as seen from outside; its trace is not a trace of the system
    itself. None if that system is too large or its answer undecided.
    """
    share = Limits(limits.remaining / 2, limits.memory)
    kept = [number for number, event in enumerate(system.events) if labels.of(event) is not None]
    try:
        small = seen_from_outside(system, kept, share)
        if small is None:
            return None
        search, seen, nodes = _searched(small, specification, labels, share, failures=failures)
    except LimitError:
        return None
    if search.found is not None:
        return _violation(search, seen, nodes, small)
    if _undecided(nodes, labels) is not None:
        return None
    reason = (
        f"composed two at a time and minimized, the processes have {counted(search.states, 'state')}, and do only "
        "what the specification does"
    )
    return Proved("minimization", reason + _caveat(specification, limits, failures), search.states)


def _caveat(specification: System, limits: Limits, failures: bool) -> str:
    if failures and isinstance(livelock_free(specification, limits), Refuted):
        return "; the specification may livelock, and what it refuses then is left open"
    return ""


def _searched(
    system: System, specification: System, labels: Labels, limits: Limits, *, failures: bool
) -> tuple[Exploration, dict[int, Label], tuple[NormalNode, ...]]:
    """The search through the system composed with the specification, the labels of its events, and the normal form of
    the specification. Raises LimitError.
    """
    seen = {number: label for number, event in enumerate(system.events) if (label := labels.of(event)) is not None}
    own = {
        number: label for number, event in enumerate(specification.events) if (label := labels.of(event)) is not None
    }
    nodes = normal_form(specification, own, dict.fromkeys(seen.values()), limits)
    packing = Packing(_followed(system, seen, nodes))
    return explore(packing, limits, _Violations(packing, seen, nodes, failures=failures)), seen, nodes


def _followed(system: System, seen: dict[int, Label], nodes: tuple[NormalNode, ...]) -> System:
    """The system with the specification as its last component, whose last state means that an event was not allowed."""
    watcher = len(system.components)
    edges = tuple(tuple((event, node.after.get(label, len(nodes))) for event, label in seen.items()) for node in nodes)
    events = tuple(
        replaced(event, parties=(*event.parties, watcher)) if number in seen else event
        for number, event in enumerate(system.events)
    )
    component = Component("specification", (*edges, ()), process=False)
    return System((*system.components, component), events)


class _Violations:
    """States in which the process has done something forbidden, or refuses what it must offer."""

    def __init__(
        self, packing: Packing, seen: dict[int, Label], nodes: tuple[NormalNode, ...], *, failures: bool
    ) -> None:
        self._seen = seen
        self._nodes = nodes
        self._failures = failures
        self._watcher = packing.fields[-1]
        self._deadlocks = Deadlocks(packing)
        self._steps = packing.steps

    def __call__(self, states: Words, can_step: Flags) -> Flags | None:
        """Which states violate the specification, if any does."""
        node = self._watcher.of(states)
        hits: Flags = node == len(self._nodes)
        wrong_end = np.array([END not in known.after for known in self._nodes] + [False])
        still = np.flatnonzero(~can_step & ~hits)
        if len(still):
            few = [word[still] for word in states]
            stuck = self._deadlocks(few, np.zeros(len(still), np.bool_))
            ended = still if stuck is None else still[~stuck]
            hits[ended] |= wrong_end[node[ended]]
        if self._failures:
            self._refusals(states, can_step, hits)
        return hits if hits.any() else None

    def _refusals(self, states: Words, can_step: Flags, hits: Flags) -> None:
        """Marks in ``hits`` the stable states that offer none of the acceptances of the specification."""
        stable = np.flatnonzero(~hits)
        for step in self._steps:
            if step.event not in self._seen and len(stable):
                stable = stable[~step.enabled([word[stable] for word in states])]
        few = [word[stable] for word in states]
        offered: dict[Label, Flags] = {}
        for step in self._steps:
            if step.event in self._seen and len(stable):
                for label in {self._seen[step.event], (self._seen[step.event][0], None)}:
                    enabled = step.enabled(few)
                    offered[label] = offered[label] | enabled if label in offered else enabled
        node = self._watcher.of(few)
        ended = ~can_step[stable]
        if ended.any():
            stuck = self._deadlocks([word[ended] for word in few], np.zeros(int(ended.sum()), np.bool_))
            if stuck is not None:
                ended[np.flatnonzero(ended)[stuck]] = False
        offered[END] = ended
        nothing = np.zeros(len(stable), np.bool_)
        for number in np.unique(node):
            fine = nothing.copy()
            for accepted in self._nodes[number].acceptances:
                all_of_it = ~nothing
                for label in accepted:
                    all_of_it = all_of_it & offered.get(label, nothing)
                fine |= all_of_it
            hits[stable] |= (node == number) & ~fine


def _violation(search: Exploration, seen: dict[int, Label], nodes: tuple[NormalNode, ...], system: System) -> Refuted:
    assert search.found is not None
    trace = trace_to(search, search.found)
    last = search.state(search.found)
    if last[-1] == len(nodes):
        before = end_of(search.packing.system.initial, trace[:-1])
        reason = forbidden_event(seen[trace[-1].event], nodes[before[-1]].after)
    else:
        reason = _refusal(search.packing, search.found, search, seen, nodes[last[-1]], system)
    watcher = len(system.components)
    moves = tuple(Move(move.event, tuple(part for part in move.moves if part[0] != watcher)) for move in trace)
    return Refuted("breadth-first", moves, states=search.states, reason=reason)


def _refusal(
    packing: Packing, number: int, search: Exploration, seen: dict[int, Label], node: NormalNode, system: System
) -> str:
    here = search.table.states(number, number + 1)
    offers = {seen[step.event] for step in packing.steps if step.event in seen and step.enabled(here)[0]}
    if not offers and Deadlocks(packing)(here, np.zeros(1, np.bool_)) is None:
        return ended_too_soon(node.after)
    return forbidden_refusal(offers, node.acceptances)
