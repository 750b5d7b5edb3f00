"""The ports of a program, grouped as in `struct network_drivers`."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.network.ir.network import ExternalPort


def port_groups(ports: Sequence[ExternalPort]) -> list[tuple[str, list[ExternalPort]]]:
    """The ports by member of `struct network_drivers`; the elements of an array are one member."""
    groups: dict[str, list[ExternalPort]] = {}
    for port in ports:
        groups.setdefault(port.name.partition("[")[0], []).append(port)
    return list(groups.items())
