"""The recording that a run was asked for: which file, and what a message says when it cannot be written."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from cspdiag.cli.support.failure import UsageError, described
from cspdiag.cli.support.files.written import file_path, require_file
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.record.stored.described import RecordingHead
    from cspdiag.simulate.record.streamed.foxglove_socket import FoxgloveSocket
    from cspdiag.simulate.record.streamed.recording import Recording


_ENDINGS = (".csv", ".npz", ".mcap", ".parquet")


def recording_path(text: str) -> str:
    """The name of a recording: of a file, or, with a slash at its end, of a ROS 2 bag folder."""
    if text.endswith(("/", os.sep)):
        name = os.path.basename(text.rstrip("/" + os.sep))
        if name in {"", os.curdir, os.pardir} or os.path.splitext(name)[1] in _ENDINGS:
            raise ArgumentTypeError(f"expected the name of a new folder, not {text!r}")
        return text
    return str(file_path(text))


def require_recording(name: str | None, option: str = "--record") -> None:
    """Refuse a recording that could not be written; ``option`` is what named it."""
    if name is None:
        return
    from cspdiag.base.errors import ArgumentError, MissingPackageError
    from cspdiag.simulate.record.streamed.formats import is_bag, part_of, require_format

    if not is_bag(name):
        require_file(option, name, _ENDINGS)
    elif os.path.lexists(name.rstrip("/" + os.sep)):
        raise UsageError(f"{option} {name}: is there already, and a bag is not overwritten")
    else:
        require_file(option, os.path.join(os.path.dirname(name.rstrip("/" + os.sep)), "metadata.yaml"))
        part = part_of(name)
        if os.path.lexists(part):
            raise UsageError(f"{option} {name}: {part} is there, of a run that did not end; move it or remove it")
    try:
        require_format(name)
    except (ArgumentError, MissingPackageError) as problem:
        raise UsageError(f"{option} {name}: {problem}") from None


def opened_recording(arguments: Namespace, network: CoreNetwork, *, tuned: bool) -> Recording | None:
    """The recording of a run, which has the parameters of the program if they may change; None if there is to be none.
    Raises UsageError, and NoEnvironmentError.
    """
    if arguments.record is None and arguments.serve is None:
        return None
    from cspdiag.simulate.record.stored.described import RecordingHead, head_of
    from cspdiag.simulate.record.stored.parameters import parameters_signal
    from cspdiag.simulate.record.streamed.formats import open_writer, part_of
    from cspdiag.simulate.record.streamed.recording import Recording
    from cspdiag.simulate.run.execute import chosen_environment

    head = head_of(network, chosen_environment(network, arguments.environment))
    parameters = parameters_signal(network) if tuned else None
    if parameters is not None:
        head = RecordingHead(head.process, head.environment, head.source, (*head.ports, parameters))
    name: str | None = arguments.record
    background = arguments.real_time and arguments.target != "c"
    listener = None if arguments.serve is None else _served(arguments.serve, head)
    if name is None:
        return Recording(head, None, on_problem=lambda *_: None, listener=listener, background=background)

    def tell(problem: OSError, until: int) -> None:
        named = OSError(problem.errno, problem.strerror or str(problem), name)
        part = part_of(name)
        left = f"; {part} has everything up to {until / 1e9:.9g} s" if os.path.exists(part) else ""
        say(f"cspdiag: {described(named)}{left}")

    try:
        writer = open_writer(name, head, arguments.messages)
    except OSError as problem:
        if listener is not None:
            listener.close()
        raise UsageError(described(OSError(problem.errno, problem.strerror, name))) from None
    return Recording(head, writer, on_problem=tell, listener=listener, background=background)


def socket_place(text: str) -> tuple[str, int]:
    """Where to listen: a port of this machine, or ``HOST:PORT``."""
    host, colon, number = text.rpartition(":")
    if not (number.isdecimal() and int(number) < 1 << 16) or (colon and not host):
        raise ArgumentTypeError(f"expected a port, or HOST:PORT, not {text!r}")
    return host or "127.0.0.1", int(number)


def _served(place: tuple[str, int], head: RecordingHead) -> FoxgloveSocket:
    from cspdiag.base.errors import MissingPackageError
    from cspdiag.simulate.record.streamed.foxglove_socket import FoxgloveSocket

    host, port = place
    try:
        socket = FoxgloveSocket(head, host, port, say=lambda fault: say(f"cspdiag: --serve: {fault}"))
    except MissingPackageError as problem:
        raise UsageError(f"--serve: {problem}") from None
    except (OSError, RuntimeError) as problem:
        reason = str(problem).removeprefix("FoxgloveError: ")
        advice = "choose an address of this machine and a free port"
        raise UsageError(f"--serve {host}:{port}: {reason}; {advice}") from None
    say(f"cspdiag: Foxglove and PlotJuggler can connect to ws://{host}:{socket.port}")
    return socket
