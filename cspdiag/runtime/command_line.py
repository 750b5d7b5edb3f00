"""Runs a network from the command line: what ``python -m`` of a generated package does."""

from __future__ import annotations

import argparse
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple, TypeVar, assert_never

from .kernel.durations import duration_of, shown
from .kernel.exceptions import described
from .kernel.signals import name_of_signal
from .kernel.stopping import HandlerFailed, Stopped, stopping
from .network import Network
from .outcome import Outcome
from .outside.drivers import Driver
from .outside.job_control import stay_running
from .outside.standard_streams import keep, standard_error, standard_output

UNSUCCESSFUL, WRONG_USAGE, BROKEN_PIPE = 1, 2, 141

T = TypeVar("T")


class Program(NamedTuple):
    """What is to be run; ``ports`` are the external ports for which an environment has drivers."""

    build: Callable[..., Network]
    environments: Mapping[str, Callable[[], Any]]
    ports: Sequence[str]


class _RefusedError(Exception):
    """The program cannot be run; the message is one line."""


def main(name: str, load: Callable[[], Program], arguments: Sequence[str] | None = None) -> int:
    """Runs a network in one of its environments and prints how it ended. Returns the exit code.

    ``load`` imports the program. Without a time limit a run lasts until the program ends or a signal arrives; outputs
    are released however it ends.
    """
    _occupy_standard_streams()
    keep()
    with stopping.until_exit(_say_line):
        try:
            with stopping.raising():
                given, environment, network = _prepared(name, load, arguments)
                if given.tune is not None:
                    _tune(name, network, given)
                stay_running(real_time=given.real_time)
        except Stopped as stopped:
            return _say(f"{name}: stopped by {name_of_signal(stopped.signal)} before it began", stopped.exit_code)
        except HandlerFailed as failed:
            return _say(f"{name} cannot be started: {failed.error}", UNSUCCESSFUL)
        except _RefusedError as refused:
            return _say(str(refused), UNSUCCESSFUL)
        outcome = network.run(
            environment=environment,
            until=given.limit,
            real_time=given.real_time,
            on_miss=getattr(environment, "on_miss", "timeout"),
        )
        account = [*_summary(outcome), *_refused_changes(network)]
        return _print_account("\n".join(account), outcome.exit_code)


def _prepared(
    name: str, load: Callable[[], Program], arguments: Sequence[str] | None
) -> tuple[argparse.Namespace, Any, Network]:
    program = _attempt(name, load)
    given = _parser(name, program.environments).parse_args(arguments)
    if program.ports and not program.environments:
        ports = ", ".join(program.ports)
        sys.exit(_say(f"{name} has no environment; build its network with drivers for {ports}", WRONG_USAGE))
    environment = _attempt(name, program.environments[given.environment]) if program.environments else None
    drivers = environment.drivers if environment is not None else {}
    return given, environment, _attempt(name, lambda: _built(program, drivers, environment))


def _built(program: Program, drivers: Mapping[str, Driver], environment: Any) -> Network:
    """The network, with the parameters of its environment if there are any."""
    parameters = getattr(environment, "parameters", None)
    return program.build(drivers) if parameters is None else program.build(drivers, parameters)


def _tune(name: str, network: Network, given: argparse.Namespace) -> None:
    """Plan the changes of parameters in a file, or those that standard input has, or will have in real time."""
    from .tuning import changes_in, read_while_running

    if not network.parameters.names:
        sys.exit(_say(f"{name} has no parameters that --tune could change", WRONG_USAGE))

    def report(text: str) -> None:
        _say_line(f"{name}: {text}")

    if given.tune == "-" and given.real_time:
        read_while_running(network, report)
        return
    try:
        with open(0 if given.tune == "-" else given.tune, encoding="utf-8") as lines:
            network.parameters.plan(list(changes_in(network.parameters, lines, report)))
    except OSError as error:
        sys.exit(_say(f"--tune {given.tune}: {error.strerror}", WRONG_USAGE))
    except UnicodeDecodeError:
        sys.exit(_say(f"--tune {given.tune}: is not text", WRONG_USAGE))


def _attempt(name: str, make: Callable[[], T]) -> T:
    """Returns what ``make`` makes, which runs modules that were written by hand. Raises _RefusedError for any
    exception.
    """
    try:
        return make()
    except BaseException as error:
        if stopping.ends_run(error):
            raise
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{os.path.basename(frame.filename)}:{frame.lineno}"
        raise _RefusedError(f"{name} cannot be started: {described(error)}, in {place}") from error


def _say(text: str, code: int) -> int:
    _say_line(text)
    return code


def _say_line(text: str) -> None:
    with suppress(OSError, ValueError, AttributeError):
        stream = standard_error()
        stream.write(f"{text}\n")
        stream.flush()


def _occupy_standard_streams() -> None:
    """If the process was started with one of them closed, the next file that is opened, such as a device, would get its
    number, and what is printed would go there.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


def _print_account(text: str, code: int, what: str = "account of the run") -> int:
    """Prints ``text`` and returns the exit code. If the text cannot be written, the code says so, unless it already
    says something more important.
    """
    try:
        print(text, file=standard_output(), flush=True)
    except BrokenPipeError:
        _drop_standard_output()
        return code or BROKEN_PIPE
    except OSError as error:
        _drop_standard_output()
        return code or _say(f"the {what} cannot be written: {error.strerror}\n{text}", UNSUCCESSFUL)
    return code


def _drop_standard_output() -> None:
    """Keeps the interpreter from flushing it once more at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), standard_output().fileno())


class _Parser(argparse.ArgumentParser):
    def print_help(self, file: object = None) -> None:
        # The method of the base class is silent about a help text that cannot be written.
        code = _print_account(self.format_help().rstrip("\n"), 0, "help")
        if code:
            sys.exit(code)


def _limit(text: str) -> int:
    """A duration. Raises ArgumentTypeError with what is wrong: argparse does not show the text of a ValueError."""
    try:
        return duration_of(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _parser(name: str, environments: Mapping[str, Callable[[], Any]]) -> argparse.ArgumentParser:
    parser = _Parser(prog=f"python -m {name}", epilog=f"example: python -m {name} --for 20s")
    if environments:
        first = next(iter(environments))
        parser.add_argument(
            "--environment",
            choices=list(environments),
            default=first,
            metavar="NAME",
            help=f"one of {', '.join(environments)} (default: {first})",
        )
    parser.add_argument("--for", dest="limit", type=_limit, metavar="TIME", help="the time limit, such as 20s")
    parser.add_argument("--real-time", action="store_true", help="run against the clock, not in virtual time")
    parser.add_argument(
        "--tune",
        nargs="?",
        const="-",
        metavar="FILE",
        help="change parameters while it runs, by lines such as `at 2 s gains.kp = 3`; without FILE from standard "
        "input, in real time as they come",
    )
    return parser


def _refused_changes(network: Network) -> Iterator[str]:
    for change, why in network.parameters.refused:
        yield f"{change.parameter} was not changed at {shown(change.time)}: {why}"


def _summary(outcome: Outcome) -> Iterator[str]:
    why = f": {described(outcome.error)}" if outcome.error is not None else ""
    yield f"{_ending(outcome)} at {shown(outcome.time)}, in {outcome.wall_time:.3g} s{why}"
    if outcome.deadlock is not None:
        yield outcome.deadlock.text
    missed = [f"{port} {count}" for port, count in outcome.missed.items() if count]
    if missed or (outcome.missed and outcome.real_time):
        yield f"missed samples: {', '.join(missed) or 'none'}"
    if outcome.preference:
        yield outcome.preference
    for period, jitter in outcome.jitter.items():
        if jitter.count:
            yield f"jitter of the {shown(period)} period: {jitter}"
    for error in outcome.release_errors:
        yield f"while releasing outputs: {described(error)}"


def _ending(outcome: Outcome) -> str:
    match outcome.ended:
        case "terminated":
            return "ended by itself"
        case "time limit":
            return "reached the time limit"
        case "failed":
            return "ended unsuccessfully"
        case "stopped":
            return f"stopped by {name_of_signal(outcome.signal)}"
        case "deadlock":
            return outcome.ended
        case _:
            assert_never(outcome.ended)
