"""``cspdiag studio``: the link, wrong arguments, and how it ends."""

from __future__ import annotations

import http.client
import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag.base.files import resources
from cspdiag.cli.main import main

pytest.importorskip("uvicorn")
PROGRAM = Path(resources.case_study())


@pytest.fixture(autouse=True)
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A page, because tests do not build that of the studio."""
    folder = tmp_path / "page"
    folder.mkdir()
    (folder / "index.html").write_text("<p>the page</p>", encoding="utf-8")
    monkeypatch.setattr(resources, "studio_page", lambda: str(folder))
    return folder


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nothing.csp"], "nothing.csp: there is no such file"),
        ([str(PROGRAM), "--port", "70000"], "--port 70000: ports are 1 to 65535"),
    ],
)
def test_wrong_arguments(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["studio", *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_program_that_is_not_text_is_refused_as_check_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "latin.csp"
    path.write_bytes("process A { composition { skip } } // café".encode("latin-1"))
    codes, messages = [], []
    for verb in ("check", "studio"):
        codes.append(main([verb, str(path)]))
        messages.append(capsys.readouterr().err)
    assert "not UTF-8 text" in messages[0]
    assert (codes[0], messages[0]) == (codes[1], messages[1])


def test_a_page_that_was_not_built(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(resources, "studio_page", lambda: None)
    assert main(["studio", str(PROGRAM)]) == 1
    assert "make studio" in capsys.readouterr().err


def test_a_port_that_is_taken(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert main(["studio", str(PROGRAM), "--no-browser", "--port", str(port)]) == 1
    assert f"--port {port}: address already in use" in capsys.readouterr().err


SCRIPT = """
import sys
from cspdiag.base.files import resources
resources.studio_page = lambda: sys.argv[1]
from cspdiag.cli.main import main
sys.exit(main(["studio", sys.argv[2], "--no-browser"]))
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, -signal.SIGTERM)])
def test_a_signal_ends_it(page: Path, tmp_path: Path, number: signal.Signals, code: int) -> None:
    program = tmp_path / "own programs" / "a#b.csp"
    program.parent.mkdir()
    program.write_text("process A() = SKIP\n", encoding="utf-8")
    command = [sys.executable, "-c", SCRIPT, str(page), str(program)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as studio:
        assert studio.stderr is not None
        link = re.fullmatch(r"the studio is at http://(127\.0\.0\.1:\d+)(/\?token=.{43})\n", studio.stderr.readline())
        assert link is not None
        connection = http.client.HTTPConnection(link[1])
        connection.request("GET", link[2])
        assert connection.getresponse().read() == b"<p>the page</p>"
        studio.send_signal(number)
        rest = studio.stderr.read()
    assert studio.returncode == code
    assert "Traceback" not in rest


def test_the_page_is_what_was_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    built = Path(resources.__file__).parents[3] / "studio" / "build"
    assert resources.studio_page() == (str(built) if (built / "main.js").exists() else None)
