"""Refinement: whether a process does only what a specification does, in traces and in stable failures (Roscoe,
"Understanding Concurrent Systems", sections 5.1 and 6.4).

The specification in normal form is added to the process as one more component, which takes part in every event that it
sees, and goes to a state of its own if an event is not allowed. So the search is the same as for deadlocks, and finds a
shortest trace. The passage of time, and steps of a process that the specification does not see, count as internal: only
a state without such steps can refuse anything.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from cspdiag.base.record import replaced
from cspdiag.model.wording import counted
from cspdiag.proofs.properties.livelock import livelock_free
from cspdiag.proofs.reduce.reduction import is_large, seen_from_outside
from cspdiag.proofs.refine.followed import Followed, Searched, followed
from cspdiag.proofs.refine.labels import Label, Labels, is_open
from cspdiag.proofs.refine.normal_form import NormalNode, normal_form
from cspdiag.proofs.refine.words import ended_too_soon, forbidden_event, forbidden_refusal
from cspdiag.proofs.search.all_states import has_vectors
from cspdiag.proofs.search.traces import end_of
from cspdiag.proofs.transitions.systems.system import INTERNAL, System
from cspdiag.proofs.verdict import LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict, reachable_states


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
        process, search = _searched(system, specification, labels, limits, failures=failures)
    except LimitError as stop:
        found = (
            f"there is a violation, but no trace to it was found: {answer.reason}; "
            if isinstance(answer, Refuted)
            else ""
        )
        return Unknown("breadth-first", f"{found}{stop}")
    if search.violation is not None:
        return _refuted(process, search, search.violation)
    if (undecided := _undecided(process.nodes, labels)) is not None:
        return Unknown("breadth-first", undecided)
    model = "stable failure" if failures else "trace"
    reason = f"every {model} in {reachable_states(search.states)} is one of the specification"
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
    share = limits.part(limits.remaining / 2)
    kept = [number for number, event in enumerate(system.events) if labels.of(event) is not None]
    try:
        small = seen_from_outside(system, kept, share)
        if small is None:
            return None
        process, search = _searched(small, specification, labels, share, failures=failures)
    except LimitError:
        return None
    if search.violation is not None:
        return _refuted(process, search, search.violation)
    if _undecided(process.nodes, labels) is not None:
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
) -> tuple[Followed, Searched]:
    """The process, followed by the specification in normal form, and the result of the search. Raises LimitError."""
    seen = {number: label for number, event in enumerate(system.events) if (label := labels.of(event)) is not None}
    own = {
        number: label for number, event in enumerate(specification.events) if (label := labels.of(event)) is not None
    }
    process = followed(system, seen, normal_form(specification, own, dict.fromkeys(seen.values()), limits))
    if has_vectors():
        from cspdiag.proofs.refine.by_vectors import violation
    else:
        from cspdiag.proofs.refine.one_by_one import violation
    return process, violation(process, limits, failures=failures)


def _refuted(process: Followed, search: Searched, state: Sequence[int]) -> Refuted:
    """The refutation by the state that a search found."""
    watcher = len(process.system.components) - 1
    if state[watcher] == len(process.nodes):
        before = end_of(process.system.initial, search.trace[:-1])
        reason = forbidden_event(process.seen[search.trace[-1].event], process.nodes[before[watcher]].after)
    else:
        reason = _refusal(process, state, process.nodes[state[watcher]])
    moves = tuple(Move(move.event, tuple(part for part in move.moves if part[0] != watcher)) for move in search.trace)
    return Refuted("breadth-first", moves, states=search.states, reason=reason)


def _refusal(process: Followed, state: Sequence[int], node: NormalNode) -> str:
    offers = process.offers(state)
    if not offers and process.has_ended(state):
        return ended_too_soon(node.after)
    return forbidden_refusal(offers, node.acceptances)
