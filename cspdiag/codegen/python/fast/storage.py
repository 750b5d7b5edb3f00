"""Where the variables of a process are stored: as local variables of its code if possible, otherwise as objects."""

from __future__ import annotations

from cspdiag.base.record import kept_for_same
from cspdiag.model.types import has_unit
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.flow.repetition import repeated_classes
from cspdiag.network.flow.written import read_before_written
from cspdiag.network.ir.actions import ChannelEnd, InputEvent, OutputEvent, ReadyEvent
from cspdiag.network.ir.network import Network, ProcessClass, channels_of
from cspdiag.network.ir.walk import parts


def local_variables(process: ProcessClass, runs_again: bool, probed: bool) -> frozenset[str]:
    """The variables that can be local: no instance and no guard uses them, and every read certainly comes after a
    write.

    With ``runs_again`` the process may run more than once, and its variables keep their values; with ``probed`` those
    with a unit are recorded.
    """
    variables = {channel.name: channel for channel in process.channels if channel.kind == "var"}
    if not variables:
        return frozenset()
    shared = set(channels_of(process.instances))
    for part in parts(process.body):
        match part:
            case InputEvent(source=ChannelEnd(channel=name)) | ReadyEvent(source=ChannelEnd(channel=name)):
                shared.add(name)
            case OutputEvent(sink=ChannelEnd(channel=name)):
                shared.add(name)
            case _:  # Any other part shares no variable.
                pass
    written = frozenset(name for name, channel in variables.items() if channel.initial is not None and not runs_again)
    early = frozenset() if process.body is None else read_before_written(process.body, variables, written)
    watched = {name for name, channel in variables.items() if probed and has_unit(channel.type)}
    return frozenset(variables) - shared - early - watched


@kept_for_same(1)
def rerun_classes(network: Network) -> frozenset[str]:
    """The process classes of which an instance may run more than once; cached for all classes of a package."""
    return frozenset(_in_order(network))


@continued
def _in_order(network: Network) -> tuple[str, ...]:
    return tuple(sorted(repeated_classes(network)))
