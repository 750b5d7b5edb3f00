"""The arguments that the command line of a package accepts."""

from __future__ import annotations

import subprocess
import sys

import pytest

from cspdiag.runtime.kernel.durations import duration_of


@pytest.mark.parametrize(
    ("text", "nanoseconds"), [("20s", 20_000_000_000), ("1.5 ms", 1_500_000), (".5us", 500), ("2min", 120_000_000_000)]
)
def test_durations(text: str, nanoseconds: int) -> None:
    assert duration_of(text) == nanoseconds


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("1h", "'1h' is not a duration such as 20s or 500ms (there are ns, us, ms, s, min)"),
        ("20", "'20' is not a duration"),
        ("9" * 400 + "s", "is longer than 292 years"),
    ],
)
def test_an_invalid_duration_is_refused_with_a_reason(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=r"^.9*(1h|20|9s). is ") as refused:
        duration_of(text)
    assert reason in str(refused.value)


def test_the_command_line_says_why_too() -> None:
    """In a separate process: a command line belongs to an entire process."""
    program = (
        "from cspdiag.runtime.command_line import Program, main\n"
        "main('nothing', lambda: Program(lambda drivers: None, {}, ()), ['--for', '1h'])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.endswith(
        "argument --for: '1h' is not a duration such as 20s or 500ms (there are ns, us, ms, s, min)\n"
    )
