"""``cspdiag studio``: show a program in the browser, and run it on this machine."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from cspdiag.cli.support.failure import FINE, NoResultError, UsageError, described, needed_packages
from cspdiag.cli.support.terminal import say

EXAMPLE = """cspdiag studio models/jiwy/jiwy.csp               # edit, run and prove it in the browser
cspdiag studio robot.csp --no-browser --port 8765 # print the link only"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="the program")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="the port on loopback (default: a free one)")
    parser.add_argument("--no-browser", action="store_true", help="only print the link")


def run(arguments: Namespace) -> int:
    """Serve pages until Ctrl-C."""
    from pathlib import Path

    from cspdiag.base.files.resources import studio_page
    from cspdiag.base.sources import read_source

    file = Path(arguments.file)
    if not file.is_file():
        raise UsageError(f"{file}: there is no such file")
    if not 0 <= arguments.port < 65536:
        raise UsageError(f"--port {arguments.port}: ports are 1 to 65535")
    read_source(str(file))
    page = studio_page()
    if page is None:
        raise NoResultError("the page of the studio is not built: make studio, which needs node and npm")
    with needed_packages("studio", "uvicorn", "starlette", "websockets"):
        import websockets  # noqa: F401 - uvicorn imports it when the first page connects

        from cspdiag.studio.server.serving import serve

    def started(link: str, first: str) -> None:
        say(f"the studio is at {link}\nWhoever has this link can run programs as you; Ctrl-C ends it.")
        if not arguments.no_browser:
            import webbrowser

            webbrowser.open(first)

    try:
        serve(file.resolve(), Path(page), arguments.port, started)
    except OSError as problem:
        raise NoResultError(f"--port {arguments.port}: {described(problem)}") from None
    return FINE
