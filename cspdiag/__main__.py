"""``python -m cspdiag``, and the command ``cspdiag``."""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """Run the command line of this process and return the exit code.

    Ctrl-C ends it without a traceback, also before it has been loaded.
    """
    try:
        from cspdiag.cli.main import main as run

        code = run()
    except KeyboardInterrupt:
        code = 130
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        # While the interpreter shuts down nothing would catch the exception.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return code


if __name__ == "__main__":
    sys.exit(main())
