"""Numbers in options: finite, and written as in the language; and the options for the numbers of a program."""

from __future__ import annotations

import math
import re
from argparse import ArgumentParser, ArgumentTypeError
from collections.abc import Callable

from cspdiag.model.types import REALS

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def number(text: str) -> float:
    """A text as a finite number. Raises ArgumentTypeError."""
    if not _NUMBER.fullmatch(text.strip()) or not math.isfinite(value := float(text)):
        raise ArgumentTypeError(f"expected a finite number, not {text!r}")
    return value


def whole_number(text: str) -> int:
    """A text as a whole number without a sign. Raises ArgumentTypeError."""
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal()) or len(digits) > 9:
        raise ArgumentTypeError(f"expected a whole number, not {text!r}")
    return int(digits)


def positive(least: float, most: float, unit: str) -> Callable[[str], float]:
    """A parser of positive numbers from ``least`` to ``most``, which raises ArgumentTypeError for any other text."""

    def read(text: str) -> float:
        try:
            value = number(text)
        except ArgumentTypeError:
            value = 0.0
        if value <= 0:
            raise ArgumentTypeError(f"expected a positive number, not {text!r}")
        if not least <= value <= most:
            raise ArgumentTypeError(f"expected {least:g} to {most:g} {unit}, not {text!r}")
        return value

    return read


def add_settings(parser: ArgumentParser) -> None:
    """Declare the option ``--set``: numbers of the program that are other ones than in its text."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        dest="settings",
        help="a constant (Tsh=10ms), a field of one (gains.kp=3) or an instance's parameter (pan.inertia=2e-3); may be "
        "given again",
    )


def add_real(parser: ArgumentParser) -> None:
    """Declare the option ``--real``: the precision that a program computes in."""
    parser.add_argument(
        "--real",
        choices=REALS,
        default="double",
        help="what `double` means in the program: with float32 it computes in single precision, on every target; "
        "environments stay in double precision (default: double)",
    )
