"""``python -m cspdiag``, and the command ``cspdiag``."""

from __future__ import annotations

# The module `signal` takes as long to load as all that asking a server takes.
import _signal  # type: ignore[import-not-found]
import gc
import os
import sys


def main() -> int:
    """Run the command line of this process and return the exit code.

    Ctrl-C ends it without a traceback, also before it has been loaded.
    """
    try:
        if "_ARGCOMPLETE" in os.environ:
            _complete_line()
        code = _by_server() if "--server" in sys.argv else _by_this_process()
    except KeyboardInterrupt:
        code = 130
    if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
        # While the interpreter shuts down nothing would catch the exception.
        _signal.signal(_signal.SIGINT, _signal.SIG_DFL)
    return code


def _complete_line() -> None:
    """Answer the shell that completes a command line (see ``cspdiag completion``), and end the process."""
    from cspdiag.cli.completion import complete

    complete()


def _by_this_process() -> int:
    # What is loaded is needed to the end, so there is no garbage to look for.
    gc.disable()
    from cspdiag.cli.main import main as run

    gc.enable()
    return run()


def _by_server() -> int:
    """Have a server carry the command out; without one, do it here, and start one for the next time."""
    from cspdiag.cli.server import client

    if not client.wanted(sys.argv[1:]):
        return _by_this_process()
    code = client.answered(sys.argv)
    if code is None:
        code = _by_this_process()
        client.start()
    return code


if __name__ == "__main__":
    sys.exit(main())
