"""Drivers that the chosen code cannot call."""

from __future__ import annotations

from cspdiag.network.ir.external import devices_in_c
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.run.execute import chosen_environment, device_in_c_refusal
from cspdiag.studio.engine.failure import RequestError


def refuse_devices(network: CoreNetwork, environment: str | None, target: str) -> None:
    """Raises RequestError for an environment with drivers that are not written for the target."""
    chosen = chosen_environment(network, environment)
    if chosen is None:
        return
    in_c = devices_in_c(chosen)
    in_python = [driver for driver in chosen.drivers if driver not in in_c]
    if in_c and target == "python":
        other = "run it as C, or " if not in_python else ""
        raise RequestError(device_in_c_refusal(in_c[0]), f"{other}choose another environment")
    if in_python and target == "c":
        from cspdiag.codegen.c.package.refusals import device_refusal

        other = "run it as Python, or " if not in_c else ""
        found = device_refusal(in_python[0].definition, in_python[0].external)
        raise RequestError(found, f"{other}choose another environment")
