"""States per second of processor time, for the breadth-first search over all states."""

from __future__ import annotations

import time

from philosophers import table
from timing import BATCHES, report, requested_benchmark, size_of

from cspdiag.proofs.search.breadth_first import count
from cspdiag.proofs.verdict import Limits

system = table(size_of(requested_benchmark()))
count(system, Limits())
for _ in range(BATCHES):
    began = time.process_time()
    states, deadlocks = count(system, Limits())
    report(states / (time.process_time() - began))
    assert deadlocks == 0
