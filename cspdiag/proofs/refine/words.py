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
    *rest, last = sorted(map(words, _any_number(labels)))
    return f"{', '.join(rest)} and {last}" if rest else last


def _any_number(labels: Collection[Label]) -> set[Label]:
    """The labels, those of a port together that has one for all whole numbers of its type: ``..-1``, ``0`` and ``1..``
    are any number.
    """
    found = set(labels)
    for port in {port for port, value in labels if value is not None and value.startswith("..")}:
        values = {value for name, value in labels if name == port and value is not None}
        if _are_all_numbers(values):
            found = found - {(port, value) for value in values} | {(port, None)}
    return found


def _are_all_numbers(values: Collection[str]) -> bool:
    """Whether the texts of numbers and of ranges leave none out."""
    limits = []
    for value in values:
        low, between, high = value.partition("..")
        try:
            limits.append((int(low) if low else None, int(high if between else low) if high or not between else None))
        except ValueError:
            return False  # The value of an enum, or one that is only passed on.
    lows = {low for low, _ in limits}
    return None in lows and all(high is None or high + 1 in lows for _, high in limits)
