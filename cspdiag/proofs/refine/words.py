"""Describes in words how a process fails to refine its specification."""

from __future__ import annotations

from collections.abc import Collection

from cspdiag.proofs.refine.labels import Label, words


def forbidden_event(label: Label, allowed: Collection[Label]) -> str:
    """The process does something that is not among what the specification allows."""
    return f"it does {words(label)}, where the specification {_allows(allowed)}"


def ended_too_soon(allowed: Collection[Label]) -> str:
    """The process ends where the specification does not."""
    return f"it ends, where the specification {_allows(allowed)}"


def forbidden_refusal(offers: Collection[Label], acceptances: Collection[Collection[Label]]) -> str:
    """The process waits and offers none of the acceptances, of which the specification demands one."""
    offered = f"only {_list(offers)}" if offers else "nothing"
    if not acceptances:
        return f"it waits and offers {offered}, where the specification never waits"
    missing = {label for accepted in acceptances for label in accepted}
    missing -= {*offers, *((port, None) for port, _ in offers)}
    open_ports = {port for port, value in offers if value is None}
    refused = {label for label in missing if label[0] not in open_ports} or missing
    wanted = ", or else ".join(map(_list, acceptances))
    return f"it refuses {_list(refused)} and offers {offered}, where the specification demands {wanted}"


def _allows(labels: Collection[Label]) -> str:
    return f"allows only {_list(labels)}" if labels else "allows nothing more"


def _list(labels: Collection[Label]) -> str:
    *rest, last = sorted(map(words, labels))
    return f"{', '.join(rest)} and {last}" if rest else last
