"""How servers begin and end, and what they keep of the commands that they carry out: nothing."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from cspdiag.cli.server import place as places
from cspdiag.cli.server.seat import seat
from tests.cli.conftest import GOOD
from tests.cli.server.commands import ROOT, Answer, Place, served

FINE = Answer(0, b"", b"checked 1 file: no errors\n")


def wait_until(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 20
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def children(process: int) -> list[int]:
    return [int(number) for number in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def test_the_first_command_answers_by_itself_and_starts_a_server(alone: Place) -> None:
    (alone.programs / "good.csp").write_text(GOOD)
    assert alone.status() == "no server is running\n"
    assert alone.is_empty(), "asking starts nothing"
    try:
        # Its output ends when the command ends: the server does not hold it.
        assert alone.check("--server", "good.csp") == FINE
        alone.wait_for_server()
        assert alone.count() == 0
        assert alone.check("--server", "good.csp") == FINE
        assert alone.count() == 1
    finally:
        stopped = alone.check("--server-stop")
    assert stopped.out.startswith(b"server ")
    assert alone.is_empty(), "no file is left behind"
    assert alone.check("--server-stop") == Answer(0, b"no server is running\n", b"")
    assert alone.check("--server-status").code == 1


def test_a_server_that_is_still_starting_is_stopped(alone: Place) -> None:
    (alone.programs / "good.csp").write_text(GOOD)
    assert alone.check("--server", "good.csp") == FINE
    wait_until(lambda: any(alone.sockets.rglob("*.lock")))
    assert alone.check("--server-stop").out.endswith(b" has stopped\n")
    assert alone.is_empty()


def test_who_asks_for_servers_keeps_none_from_its_place(alone: Place, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = alone.sockets / "cspdiag"
    folder.mkdir(mode=0o700)
    (folder / "another.lock").touch()
    # There is always a lock to ask for, as one that a killed server has left.
    program = f"""
import pathlib
from cspdiag.cli.server.seat import is_taken
print("asks", flush=True)
while True:
    pathlib.Path({str(folder)!r}, "name.lock").touch()
    is_taken("name")
"""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(alone.sockets))
    with subprocess.Popen([sys.executable, "-c", program], env=alone.environment, stdout=subprocess.PIPE) as asking:
        try:
            assert asking.stdout is not None
            assert asking.stdout.readline() == b"asks\n"
            for _ in range(2000):
                with seat("name") as taken:
                    assert taken is not None
        finally:
            asking.kill()


@pytest.mark.parametrize(
    "options", [("--server-stop", "--server-status"), ("--server-stop", "x.csp"), ("--server-status", "--server")]
)
def test_what_has_no_effect_is_refused(alone: Place, options: tuple[str, ...]) -> None:
    refused = alone.check(*options)
    assert refused.code == 2
    assert options[0].encode() in refused.err or options[1].encode() in refused.err


def test_a_server_holds_nothing_of_its_callers(alone: Place) -> None:
    # As a hook may have: a pipe besides the standard streams, whose end is awaited.
    ours, theirs = os.pipe()
    process = alone.start("--server", "nothing.csp", pass_fds=[theirs])
    os.close(theirs)
    process.communicate(timeout=60)
    with served(alone):
        assert os.read(ours, 1) == b""
        server = alone.server()
        assert os.getsid(server) == server
        assert os.readlink(f"/proc/{server}/cwd") == "/"
        held = {os.readlink(f"/proc/{server}/fd/{number}") for number in range(3)}
        assert held == {os.devnull}
        # Besides these the folder, the lock and the socket; and the connection of the last question, for a moment.
        wait_until(lambda: len(os.listdir(f"/proc/{server}/fd")) == 6)
    os.close(ours)


def test_commands_at_the_same_time_start_one_server_and_are_all_answered(alone: Place) -> None:
    (alone.programs / "good.csp").write_text(GOOD)
    with served(alone):
        started = [alone.start("--server", "good.csp") for _ in range(8)]
        answers = [Answer(0, *process.communicate(timeout=60)) for process in started]
        assert answers == [FINE] * 8
        assert alone.status().count("\n") == 1
        # No process is left behind; a child may end a moment after its answer.
        wait_until(lambda: children(alone.server()) == [])


def test_two_first_commands_start_one_server(alone: Place) -> None:
    try:
        for process in [alone.start("--server", "nothing.csp") for _ in range(3)]:
            process.communicate(timeout=60)
        alone.wait_for_server()
        assert alone.status().count("\n") == 1
    finally:
        alone.check("--server-stop")
    # Those that came too late have ended by themselves, or the test fails.
    wait_until(alone.is_empty)


def test_an_idle_server_ends_and_leaves_nothing(alone: Place) -> None:
    program = "from cspdiag.cli.server import place, resident; resident.serve(place.name_of(place.identity()), 0.2)"
    subprocess.run([sys.executable, "-c", program], env=alone.environment, timeout=60, check=True)
    assert alone.is_empty()


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_a_server_that_is_asked_to_end_leaves_nothing(place: Place, how: signal.Signals) -> None:
    os.kill(place.server(), how)
    wait_until(place.is_empty)


def test_a_killed_server_is_replaced(place: Place) -> None:
    (place.programs / "good.csp").write_text(GOOD)
    killed = place.server()
    os.kill(killed, signal.SIGKILL)
    wait_until(lambda: not is_running(killed))
    assert not place.is_empty()
    with served(place):
        assert place.check("--server", "good.csp") == FINE
        assert place.server() != killed
    assert place.is_empty()


def test_memory_does_not_grow(place: Place) -> None:
    def resident() -> int:
        return int(Path(f"/proc/{server}/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

    def check_changed(number: int) -> None:
        (place.programs / "good.csp").write_text(f"{GOOD}\n// {number}\n" + f"// {'x' * 70}\n" * 2000)
        assert place.check("--server", "good.csp") == FINE
        time.sleep(0.05)

    server = place.server()
    for number in range(10):
        check_changed(number)
    before = resident()
    for number in range(10, 40):
        check_changed(number)
    assert resident() < before + 2_000_000
    assert children(server) == []


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_command_that_is_ended_ends_its_process(place: Place, how: signal.Signals) -> None:
    server = place.server()
    process = place.start("--server", "-")
    wait_until(lambda: len(children(server)) == 1)
    time.sleep(0.3)
    process.send_signal(how)
    assert process.wait(timeout=20) == (130 if how == signal.SIGINT else -how)
    wait_until(lambda: children(server) == [])
    assert process.communicate() == (b"", b"")


def test_code_that_has_changed_is_never_answered_by_an_old_server(tmp_path: Path) -> None:
    package = tmp_path / "checkout"
    for folder in ("cspdiag", "grammars", "manual", "models/jiwy"):
        shutil.copytree(ROOT / folder, package / folder, ignore=shutil.ignore_patterns("__pycache__"))
    place = Place(tmp_path, package)
    (place.programs / "good.csp").write_text(GOOD)
    with served(place):
        assert place.check("--server", "good.csp") == FINE
        old = place.server()
        formats = package / "cspdiag/cli/support/diagnostic_formats.py"
        formats.write_text(formats.read_text().replace("no errors", "no mistakes"))
        assert place.check("--server", "good.csp").err == b"checked 1 file: no mistakes\n"
        wait_until(lambda: not is_running(old))
        place.wait_for_server()
        assert place.both("good.csp")[1].err == b"checked 1 file: no mistakes\n"


def test_a_folder_that_others_can_enter_is_not_used(alone: Place) -> None:
    (alone.programs / "good.csp").write_text(GOOD)
    (alone.sockets / "cspdiag").mkdir(mode=0o755)
    assert alone.check("--server", "good.csp") == FINE
    assert alone.status() == "no server is running\n"
    assert list((alone.sockets / "cspdiag").iterdir()) == []


def test_a_folder_that_cannot_be_made_prevents_nothing(alone: Place) -> None:
    (alone.programs / "good.csp").write_text(GOOD)
    (alone.sockets / "cspdiag").write_text("a file")
    assert alone.check("--server", "good.csp") == FINE


def test_other_users_are_not_answered(place: Place, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(place.sockets))
    (name,) = [file.name for file in (place.sockets / "cspdiag").iterdir() if file.suffix != ".lock"]
    places.connect(name).close()
    monkeypatch.setattr(places, "open_folder", lambda: os.open(place.sockets / "cspdiag", os.O_RDONLY))
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    with pytest.raises(PermissionError):
        places.connect(name)


def test_a_server_with_other_settings_of_the_interpreter_is_another_one(place: Place) -> None:
    (place.programs / "good.csp").write_text(GOOD)
    place.environment["PYTHONIOENCODING"] = "latin-1"
    try:
        assert place.check("--server", "good.csp") == FINE
        wait_until(lambda: place.status().count("\n") == 2)
    finally:
        place.check("--server-stop")
