"""The search for a violation by vectors of numpy, many states at once."""

from __future__ import annotations

import numpy as np

from cspdiag.proofs.refine.followed import Followed, Searched
from cspdiag.proofs.refine.labels import END, Label
from cspdiag.proofs.search.breadth_first import explore, trace_to
from cspdiag.proofs.search.packed_conditions import Deadlocks
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.verdict import Limits


def violation(process: Followed, limits: Limits, *, failures: bool) -> Searched:
    """The first state found in which the process violates its specification. Raises LimitError."""
    packing = Packing(process.system)
    search = explore(packing, limits, _Violations(packing, process, failures=failures))
    if search.found is None:
        return Searched(search.states)
    return Searched(search.states, trace_to(search, search.found), search.state(search.found))


class _Violations:
    """States in which the process has done something forbidden, or refuses what it must offer."""

    def __init__(self, packing: Packing, process: Followed, *, failures: bool) -> None:
        self._seen = process.seen
        self._nodes = process.nodes
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
