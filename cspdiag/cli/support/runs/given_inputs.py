"""The recording that a run takes its inputs from."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from cspdiag.cli.support.failure import NoResultError, UsageError, described
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.record.stored.inputs import RecordedInputs


def given_inputs(arguments: Namespace, network: CoreNetwork) -> RecordedInputs | None:
    """The inputs from ``--inputs``; None without it. Raises UsageError, NoResultError and NoEnvironmentError."""
    if arguments.inputs is None:
        return None
    for option in ("real_time", "on"):
        if getattr(arguments, option):
            raise UsageError(f"--inputs is not for --{option.replace('_', '-')}: a recording has its own time")
    from cspdiag.base.errors import MissingPackageError
    from cspdiag.runtime.kernel.durations import shown
    from cspdiag.simulate.record.stored.given import NoInputsError, inputs_of
    from cspdiag.simulate.record.stored.recording import InputsError, RecordingError

    try:
        inputs = inputs_of(network, arguments.environment, arguments.inputs)
    except NoInputsError as problem:
        raise UsageError(f"--inputs: {problem}") from None
    except MissingPackageError as problem:
        raise UsageError(str(problem)) from None
    except (InputsError, RecordingError) as problem:
        raise NoResultError(f"--inputs {problem}") from None
    except OSError as problem:
        raise UsageError(f"--inputs {described(problem)}") from None
    if not inputs.recording.whole and not arguments.quiet:
        say(f"cspdiag: {arguments.inputs} was cut off: its inputs end at {shown(inputs.end)}")
    return inputs


def limited(until: int | None, inputs: RecordedInputs | None) -> int | None:
    """The time limit, not later than the end of the inputs. Raises UsageError if it was to be later."""
    if inputs is None:
        return until
    from cspdiag.runtime.kernel.durations import shown

    if until is not None and until > inputs.end:
        raise UsageError(f"--inputs {inputs.recording.path} ends at {shown(inputs.end)}, before --for {shown(until)}")
    return inputs.end if until is None else until
