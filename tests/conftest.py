from __future__ import annotations

import ctypes
import gc
import os
import signal
import sys
import threading
import time
from collections.abc import Generator
from contextlib import suppress
from pathlib import Path

import hypothesis
import pytest

from tests.support.compiling import use_ccache
from tests.support.signals import hear_signals

_BECOME_PARENT_OF_ORPHANS = 36
"""PR_SET_CHILD_SUBREAPER of Linux."""
_HOME = os.getcwd()
"""The working folder of the whole run."""
_MAX_OBJECTS = 50_000
"""New objects after which the interpreter collects garbage."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-cases", action="store_true", help="rewrite the expected blocks of the literate cases in tests/cases"
    )
    parser.addoption("--update-golden", action="store_true", help="rewrite the generated packages in tests/golden")


def pytest_configure(config: pytest.Config) -> None:
    hear_signals()
    use_ccache()
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_BECOME_PARENT_OF_ORPHANS, 1, 0, 0, 0)


def pytest_collection_finish() -> None:
    """Keep the modules and the tests themselves, which stay, out of collections of garbage, and collect seldom."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(_MAX_OBJECTS, 20, 20)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """No test leaves behind a process, its own or one that its own has left, or a thread, which might still raise."""
    before = _processes()
    threads = set(threading.enumerate())
    try:
        yield
    finally:
        left = _processes() - before
        deadline = time.monotonic() + 2
        started = [thread for thread in threading.enumerate() if thread not in threads and not _is_kept(thread)]
        alive = [thread.name for thread in started if _is_alive(thread, deadline)]
        while left and time.monotonic() < deadline:
            time.sleep(0.02)
            left &= _processes()
        names = [_killed(process) for process in left]
    if names:
        pytest.fail(f"processes were left behind: {', '.join(names)}")
    if alive:
        pytest.fail(f"threads were left behind: {', '.join(alive)}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, None, None]:
    """No test leaves the working folder: those after it in the same worker would not find the files of the
    repository.
    """
    yield
    left_in = _working_folder()
    if left_in != _HOME:
        os.chdir(_HOME)
        pytest.fail(f"the working folder was left at {left_in}")


def _working_folder() -> str:
    try:
        return os.getcwd()
    except FileNotFoundError:
        return "a folder that does not exist any more"


def _is_kept(thread: threading.Thread) -> bool:
    """Whether it belongs to the layout engine, which waits for the next drawing, or to a server of a fixture, which
    reads files in it.
    """
    return thread.name.startswith(("layout", "quickjs-worker", "AnyIO worker"))


def _is_alive(thread: threading.Thread, deadline: float) -> bool:
    """Whether it has not ended by the deadline. If it has ended, pytest knows what it has raised."""
    thread.join(max(0, deadline - time.monotonic()))
    return thread.is_alive()


def _processes() -> set[int]:
    """Child processes that are running."""
    found = set()
    for task in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):
            found |= {int(number) for number in task.read_text().split()}
    return {process for process in found if _state(process) not in ("Z", "X", "")}


def _state(process: int) -> str:
    with suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    return ""


def _killed(process: int) -> str:
    name = str(process)
    with suppress(OSError):
        name = Path(f"/proc/{process}/cmdline").read_text().replace("\0", " ").strip() or name
        os.kill(process, signal.SIGKILL)
    return name


# The same examples on every run; HYPOTHESIS_PROFILE=explore looks for new ones.
hypothesis.settings.register_profile("steady", deadline=None, derandomize=True)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000, print_blob=True)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))
