"""Processes that end with the one that they work for, however that one ends."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

CHILD = """
import sys, time
from cspdiag.base.parent import end_with_input
end_with_input()
assert sys.stdin.read() == ""
print("working", flush=True)
time.sleep(1000)
"""

BY_LINES = """
import time
from cspdiag.base.parent import lines_of_input
for line in lines_of_input():
    print(line, end="", flush=True)
    time.sleep(1000)
"""

PARENT = f"""
import subprocess, sys, threading

def start():
    global child
    child = subprocess.Popen([sys.executable, "-c", {CHILD!r}], stdin=subprocess.PIPE)

# The thread that has started it ends, which is no reason to end.
thread = threading.Thread(target=start)
thread.start()
thread.join()
sys.stdin.readline()
"""


@pytest.mark.parametrize("how", ["is killed", "ends"])
def test_a_process_ends_with_the_one_that_has_started_it(how: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PARENT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdin is not None
        assert parent.stdout is not None
        assert parent.stdout.readline() == "working\n"
        if how == "is killed":
            parent.kill()
        else:
            parent.stdin.close()
        # The end of what the child writes, too.
        assert parent.stdout.read() == ""


def test_it_is_asked_to_end_as_by_sigterm() -> None:
    with subprocess.Popen([sys.executable, "-c", CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        assert child.stdout.readline() == b"working\n"
        child.stdin.close()
        assert child.wait(60) == -signal.SIGTERM


def test_it_ends_while_it_works_on_a_line_of_its_input() -> None:
    with subprocess.Popen([sys.executable, "-c", BY_LINES], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        child.stdin.write(b"first\nsecond\n")
        child.stdin.flush()
        assert child.stdout.readline() == b"first\n"
        child.stdin.close()
        assert child.wait(60) == -signal.SIGTERM
