"""``cspdiag show``: what a recording has."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError, described
from cspdiag.cli.support.files.written import file_path, require_different, require_file
from cspdiag.cli.support.runs.recorded import recording_path, require_recording
from cspdiag.cli.support.terminal import say, write_out

EXAMPLE = "cspdiag show jiwy.mcap --plot jiwy.svg\ncspdiag show run.part.mcap --save run.parquet"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "file", metavar="FILE", help="a recording: .mcap, .parquet, .csv, .npz or a ROS 2 bag folder, whole or not"
    )
    parser.add_argument("--plot", type=file_path, metavar="FILE", help="a figure, as .svg, .png or .pdf")
    parser.add_argument(
        "--save", type=recording_path, metavar="FILE", help="the same recording in another format, or made whole"
    )


def run(arguments: Namespace) -> int:
    """Print the summary; the exit code is 1 for a recording that is not whole."""
    from cspdiag.base.errors import MissingPackageError
    from cspdiag.simulate.record.stored.open_recording import open_recording
    from cspdiag.simulate.record.stored.recording import RecordingError
    from cspdiag.simulate.record.stored.shown import plot, text_of
    from cspdiag.simulate.record.streamed.formats import save

    require_file("--plot", arguments.plot, (".svg", ".png", ".pdf"))
    require_recording(arguments.save, "--save")
    require_different({"the recording": arguments.file, "--plot": arguments.plot, "--save": arguments.save})
    try:
        recording = open_recording(arguments.file)
        write_out(text_of(recording))
        if arguments.save is not None:
            save(recording, arguments.save)
        if arguments.plot is not None:
            plot(recording, arguments.plot)
    except MissingPackageError as problem:
        raise UsageError(str(problem)) from None
    except RecordingError as problem:
        raise NoResultError(str(problem)) from None
    except OSError as problem:
        raise UsageError(described(problem)) from None
    for written in filter(None, (arguments.save, arguments.plot)):
        say(f"wrote {written}")
    return FINE if recording.whole else UNSUCCESSFUL
