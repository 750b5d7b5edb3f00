"""Whether a program certainly never ends by itself."""

from __future__ import annotations

from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir.actions import RaiseException
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import all_actions


def never_ends(network: Network) -> bool:
    """Whether no path leads to the end of the outermost process, because some part before it always runs forever.

    Missed samples and faults are not considered, and for a program with a ``raise`` of its own the answer is False.
    """
    processes = [entry for entry in network.classes if isinstance(entry, ProcessClass)]
    # A `raise` may end parts that would otherwise run forever.
    if any(isinstance(part, RaiseException) for process in processes for part in all_actions(process.body)):
        return False
    endless: set[str] = set()
    for process in processes:
        stuck = {instance.name for instance in process.instances if instance.class_name in endless}
        if process.body is not None and not may_end(process.body, stuck):
            endless.add(process.name)
    return network.top in endless
