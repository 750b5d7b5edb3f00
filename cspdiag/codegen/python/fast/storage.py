"""Where the variables of a process live: as local variables of its code where that can be, as objects where not."""

from __future__ import annotations

from functools import lru_cache

from cspdiag.model.types import has_unit
from cspdiag.network.flow.again import classes_run_again
from cspdiag.network.flow.written import read_before_written
from cspdiag.network.ir.actions import ChannelEnd, InputEvent, OutputEvent, ReadyEvent
from cspdiag.network.ir.network import Network, ProcessClass, channels_of
from cspdiag.network.ir.walk import parts


def local_variables(process: ProcessClass, again: bool, probed: bool) -> frozenset[str]:
    """The variables that can be local: no instance has them, no guard, and every read surely comes after a write.

    ``again`` tells that the process may be run more than once, with its variables as they were left; ``probed`` that
    those with a unit are watched from outside.
    """
    variables = {channel.name: channel for channel in process.channels if channel.kind == "var"}
    shared = set(channels_of(process.instances))
    for part in parts(process.body):
        match part:
            case InputEvent(source=ChannelEnd(channel=name)) | ReadyEvent(source=ChannelEnd(channel=name)):
                shared.add(name)
            case OutputEvent(sink=ChannelEnd(channel=name)):
                shared.add(name)
            case _:  # Any other part shares no variable.
                pass
    written = frozenset(name for name, channel in variables.items() if channel.initial is not None and not again)
    early = frozenset() if process.body is None else read_before_written(process.body, variables, written)
    watched = {name for name, channel in variables.items() if probed and has_unit(channel.type)}
    return frozenset(variables) - shared - early - watched


@lru_cache(maxsize=1)
def run_again(network: Network) -> frozenset[str]:
    """The process classes of which an instance may be run more than once; every class of a package asks."""
    return classes_run_again(network)
