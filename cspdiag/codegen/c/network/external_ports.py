"""The ports of a program: what they are called, and how they stand together."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.network.ir.network import ExternalPort


def port_groups(ports: Sequence[ExternalPort]) -> list[tuple[str, list[ExternalPort]]]:
    """The ports by member of `struct network_drivers`: elements of an array together."""
    groups: dict[str, list[ExternalPort]] = {}
    for port in ports:
        groups.setdefault(port.name.partition("[")[0], []).append(port)
    return list(groups.items())
