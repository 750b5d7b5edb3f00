"""Whether a program surely never ends by itself."""

from __future__ import annotations

from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir.actions import RaiseException
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import parts


def never_ends(network: Network) -> bool:
    """Whether no path leads to the end of the outermost process: some part before it always runs forever. Missed
    samples and faults are not considered, and a program that raises exceptions of its own is not judged.
    """
    processes = [entry for entry in network.classes if isinstance(entry, ProcessClass)]
    # After a `raise` parts end that would not.
    if any(isinstance(part, RaiseException) for part in parts([process.body for process in processes])):
        return False
    endless: set[str] = set()
    for process in processes:
        stuck = {instance.name for instance in process.instances if instance.class_name in endless}
        if process.body is not None and not may_end(process.body, stuck):
            endless.add(process.name)
    return network.top in endless
