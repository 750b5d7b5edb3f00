"""``cspdiag run``: run a program against an environment."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import UNSUCCESSFUL, NoResultError, UsageError, require_package
from cspdiag.cli.support.files.written import file_path, given_name, require_different, require_file, say_earlier
from cspdiag.cli.support.numbers import add_real, add_settings
from cspdiag.cli.support.runs.given_inputs import given_inputs, limited
from cspdiag.cli.support.runs.recorded import opened_recording, recording_path, require_recording, socket_place
from cspdiag.cli.support.runs.requested import Given
from cspdiag.cli.support.runs.simulated import simulate
from cspdiag.cli.support.terminal import say, show_diagnostics

if TYPE_CHECKING:
    from cspdiag.cli.support.runs.tuned import Tuning
    from cspdiag.pipeline import Built
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording
    from cspdiag.simulate.result import Run

EXAMPLE = (
    "cspdiag run models/jiwy/jiwy.csp --for 20s --plot jiwy.svg --record jiwy.csv\n"
    "cspdiag run models/jiwy/jiwy.csp --set Tsh=10ms --set pan.inertia=2e-3\n"
    "cspdiag run models/dining/deadlock.csp --replay trace.json"
)


_ENDINGS = {
    "trace": (".json", ".jsonl"),
    "plot": (".svg", ".png", ".pdf"),
    "json": (".json",),
}
_OUTPUTS = ("record", *_ENDINGS, "draw-deadlock")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument("--environment", metavar="NAME", help="the environment to run in (default: the first)")
    parser.add_argument("--for", dest="until", metavar="TIME", help="end after this time, such as 20s or 500ms")
    parser.add_argument("--real-time", action="store_true", help="run against the clock instead of in virtual time")
    add_settings(parser)
    add_real(parser)
    parser.set_defaults(real=None)  # A trace that is replayed has its own.
    parser.add_argument(
        "--target",
        choices=("python", "c", "auto"),
        default="python",
        help="what to run it on; auto: a native program if there can be one, which gives the same results sooner "
        "(default: python)",
    )
    parser.add_argument(
        "--on",
        metavar="BOARD",
        help="with --target c: run it on an emulated processor, to the same results: cortex-m0, cortex-m3, cortex-m4, "
        "cortex-m7 or riscv32",
    )
    level = parser.add_mutually_exclusive_group()
    level.add_argument("-O0", dest="level", action="store_const", const=0, default=1, help="run readable code")
    level.add_argument("-O1", dest="level", action="store_const", const=1, help="run fast code (default)")
    level.add_argument(
        "-O",
        dest="level",
        type=_level,
        metavar="reference",
        help="run the language reference itself, as a program: slowly",
    )
    parser.add_argument(
        "--record", type=recording_path, metavar="FILE",
        help="the external ports over time, as .csv, .npz, .mcap or .parquet; with a / at its end a ROS 2 bag folder",
    )  # fmt: skip
    parser.add_argument(
        "--serve", type=socket_place, nargs="?", const=("127.0.0.1", 8765), metavar="PORT",
        help="show the external ports to Foxglove and PlotJuggler over a WebSocket (default: 8765, this machine only)",
    )  # fmt: skip
    parser.add_argument(
        "--inputs",
        type=given_name,
        metavar="FILE",
        help="take the inputs from a recording instead of the environment, to its end",
    )
    parser.add_argument(
        "--tune", type=given_name, nargs="?", const="-", metavar="FILE",
        help="change parameters while the program runs, by lines such as `at 2 s gains.kp = 3`; without FILE from "
        "standard input, in real time as they come",
    )  # fmt: skip
    parser.add_argument(
        "--messages", choices=("ros2", "json"), default="ros2",
        help="what an .mcap file consists of: messages of ROS 2, exact and fast, or JSON (default: ros2)",
    )  # fmt: skip
    parser.add_argument(
        "--trace", type=file_path, metavar="FILE", help="Chrome trace events as .json, or the plain trace as .jsonl"
    )
    parser.add_argument("--plot", type=file_path, metavar="FILE", help="a figure, as .svg, .png or .pdf")
    parser.add_argument(
        "--json", type=file_path, metavar="FILE",
        help="how the run ended, and for each external port the number of values and of their changes, the least, the "
        "greatest and the last one",
    )  # fmt: skip
    parser.add_argument(
        "--draw-deadlock", type=file_path, metavar="FILE",
        help="if the run ends in a deadlock: the waiting processes, as .svg, .png or .pdf",
    )  # fmt: skip
    parser.add_argument(
        "--replay", type=file_path, metavar="FILE", help="step through the counterexample that verify --trace-out wrote"
    )
    parser.add_argument(
        "--place", metavar="NAME@HOST:PORT",
        help="run this place of the environment, together with the other places; the first one listens at the address",
    )  # fmt: skip
    parser.add_argument("--quiet", action="store_true", help="no summary and no progress")


def _level(text: str) -> int | str:
    """The level for ``-O`` followed by a text; ``-O0`` and ``-O1`` are options of their own."""
    levels: dict[str, int | str] = {"0": 0, "1": 1, "reference": "reference"}
    if text not in levels:
        raise ArgumentTypeError(f"there is no -O{text}: choose -O0, -O1 or -O reference")
    return levels[text]


def run(arguments: Namespace) -> int:
    """Compile, run, record; the exit code says how the run ended."""
    if arguments.replay is not None:
        from cspdiag.cli.verbs.replay import run as run_replay

        return run_replay(arguments)
    for option, endings in _ENDINGS.items():
        require_file(f"--{option}", getattr(arguments, option), endings)
    require_recording(arguments.record)
    if arguments.inputs is not None:
        require_different({"--inputs": arguments.inputs, "--record": arguments.record})
    named = {f"--{option}": getattr(arguments, option.replace("-", "_")) for option in _OUTPUTS}
    require_different({"the program": arguments.file, **named})
    if arguments.plot is not None:
        require_package("--plot", "matplotlib", "plot")
    if arguments.draw_deadlock is not None:
        from cspdiag.cli.support.deadlock_picture import check_picture

        check_picture("--draw-deadlock", arguments.draw_deadlock)
    if arguments.level == "reference":
        _refuse_unsupported_by_reference(arguments)
    if arguments.on is not None:
        _refuse_unsupported_on_board(arguments)
    if arguments.place is not None:
        from cspdiag.cli.support.runs.placed import refuse_unsupported

        refuse_unsupported(arguments)
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.settings import SettingError, parse_time_limit

    try:
        until = None if arguments.until is None else parse_time_limit(arguments.until)
        built = _built(arguments)
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    if built.network is None:
        return UNSUCCESSFUL
    from cspdiag.cli.support.runs.conclude import conclude
    from cspdiag.runtime.kernel.signals import name_of_signal
    from cspdiag.runtime.kernel.stopping import HandlerFailed, Stopped, stopping
    from cspdiag.runtime.outside.job_control import stay_running
    from cspdiag.simulate.native.values import NoEnumeratorError

    with stopping.until_exit(lambda text: say(f"cspdiag: {text}")) if arguments.whole_process else stopping:
        if arguments.whole_process:
            stay_running(real_time=arguments.real_time)
        try:
            result, recording = _recorded(arguments, built, until)
        except Stopped as stopped:
            say(f"cspdiag: stopped by {name_of_signal(stopped.signal)} before the run began")
            return stopped.exit_code
        except HandlerFailed as failed:
            raise NoResultError(str(failed.error)) from None
        try:
            return conclude(arguments, result, built.checked, recording)
        except NoEnumeratorError as problem:
            raise NoResultError(str(problem)) from None


def _refuse_unsupported_by_reference(arguments: Namespace) -> None:
    """Refuse what the reference semantics does not have: a clock, source places, execution times."""
    trace = arguments.trace
    refused = {
        "--target": arguments.target != "python",
        "--real-time": arguments.real_time,
        "--plot": arguments.plot is not None,
        "--draw-deadlock": arguments.draw_deadlock is not None,
        "--trace FILE.json": trace is not None and trace.suffix == ".json",
    }
    for option, given in refused.items():
        if given:
            other = "--trace FILE.jsonl has its trace" if option.startswith("--trace") else "use -O0 or -O1"
            raise UsageError(f"{option} is not for -O reference, which has virtual time and the plain trace: {other}")


def _refuse_unsupported_on_board(arguments: Namespace) -> None:
    from cspdiag.simulate.native.boards import BOARDS

    if arguments.on not in BOARDS:
        raise UsageError(f"unknown board {arguments.on!r} (there are: {', '.join(BOARDS)})")
    if arguments.target != "c":
        raise UsageError(f"--on {arguments.on} needs --target c")
    if arguments.real_time:
        raise UsageError("--real-time is not for --on: an emulated processor has virtual time")


def _built(arguments: Namespace) -> Built:
    from cspdiag import pipeline
    from cspdiag.settings import split_settings

    settings = split_settings(arguments.settings)
    built = pipeline.build(
        read_source(arguments.file),
        read_source,
        environment=arguments.environment,
        settings=settings,
        alone=True,
        real=arguments.real or "double",
    )
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    return built


def _recorded(arguments: Namespace, built: Built, until: int | None) -> tuple[Run, Recording | None]:
    """The run, and its recording, which is not finished."""
    from cspdiag.cli.support.runs.tuned import tuning_of
    from cspdiag.simulate.record.stored.inputs import with_environment
    from cspdiag.simulate.record.streamed.formats import part_of
    from cspdiag.simulate.run.execute import NoEnvironmentError

    program, network = built.checked.program, built.network
    assert program is not None
    assert network is not None
    if arguments.inputs is not None and arguments.environment is None:
        network = with_environment(network)
    try:
        tuning = tuning_of(arguments, program, network)
        inputs = given_inputs(arguments, network)
        until = limited(until, inputs)
        recording = opened_recording(arguments, network, tuned=_is_tuned(tuning, inputs))
        try:
            return simulate(arguments, network, until, Given(recording, inputs, tuning)), recording
        except BaseException:
            if recording is not None and recording.break_off():
                say(f"cspdiag: {part_of(arguments.record)} has what was recorded until then")
            raise
    except NoResultError:
        say_earlier(getattr(arguments, option.replace("-", "_")) for option in _OUTPUTS)
        raise
    except NoEnvironmentError as problem:
        raise UsageError(str(problem)) from None


def _is_tuned(tuning: Tuning | None, inputs: RecordedInputs | None) -> bool:
    """Whether parameters may change during the run."""
    return tuning is not None or (inputs is not None and bool(inputs.parameter_changes))
