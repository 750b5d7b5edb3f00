"""The arguments that the command line of a package accepts."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from random import Random

import pytest

from cspdiag.runtime.kernel.durations import duration_of
from cspdiag.settings import SettingError, parse_duration


@pytest.mark.parametrize(
    ("text", "nanoseconds"), [("20s", 20_000_000_000), ("1.5 ms", 1_500_000), (".5us", 500), ("2min", 120_000_000_000)]
)
def test_durations(text: str, nanoseconds: int) -> None:
    assert duration_of(text) == nanoseconds


_FORMATS = ("%d %s", "%d.%d%s", "%d.%de-3 %s", "%d.5 %s", "0.%d e3%s")


def test_durations_are_those_of_the_language() -> None:
    """To the nanosecond: a package must not run longer than ``cspdiag run``, or be tuned at another time."""
    random = Random(1)
    texts = ["0.5 ns", "2.5ns", "1e3 ns", "1.0000000005 s", "3 Hz", "7 kHz", "0.3MHz", "0 Hz", "9223372036.854775807 s"]
    texts += ["9223372036.8547758075 s", "1e30 s", "1e-30 s", "1e999s", "5 h", "", "5", "\u0663 s", "5 s 3 ms"]
    for _ in range(300):
        format_ = random.choice(_FORMATS)
        numbers = [random.randrange(10 ** random.randrange(1, 12)) for _ in range(format_.count("%d"))]
        texts.append(format_ % (*numbers, random.choice(["ns", "us", "ms", "s", "min", "Hz", "kHz", "MHz"])))
    for text in texts:
        assert _or_refused(duration_of, text) == _or_refused(parse_duration, text), text


def _or_refused(read: Callable[[str], int], text: str) -> int | str:
    try:
        return read(text)
    except (ValueError, SettingError):
        return "refused"


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
