"""Long statements are broken over lines exactly as ``ruff format`` breaks them."""

from __future__ import annotations

import random
import subprocess
import sys

import pytest

from cspdiag.codegen.python.text.code import (
    COMPARISON,
    NOT,
    OR,
    PRODUCT,
    SIGN,
    SUM,
    Argument,
    Call,
    Code,
    Conditional,
    Constant,
    Items,
    Name,
    Named,
    Parenthesized,
    Prefix,
    at_least,
    awaited,
    delegated,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.layout import LINE_LENGTH, comment_line
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import PASS, Statement, Unpack, assign, if_, lines, nonlocal_, return_, run

NAMES = (
    *map(Name, ("x", "pan_angle", "joystick_horizontal", "k1_pan_motor_speed", "h")),
    own("stiffness"),
    Constant("0.5"),
)


def expression(random: random.Random, depth: int) -> Code:
    kind = random.randrange(10) if depth > 0 else 0
    below = depth - 1
    match kind:
        case 1 | 2:
            operators = random.choice(((SUM, "+-"), (PRODUCT, "*/")))
            code = expression(random, below)
            for _ in range(random.randint(1, 4)):
                code = infix(random.choice(operators[1]), operators[0], code, expression(random, below))
            return code
        case 3:
            return infix(random.choice(("<", "==")), COMPARISON, expression(random, below), expression(random, below))
        case 4:
            return Conditional(
                at_least(expression(random, below), OR),
                at_least(expression(random, below), OR),
                expression(random, below),
            )
        case 5 | 6:
            count = random.randint(1, 4)
            names = [random.choice((None, None, "feedback", "source")) for _ in range(count)]
            seen: set[str | None] = set()
            arguments = []
            for name in sorted(names, key=lambda name: name is not None):
                if name is None or name not in seen:
                    arguments.append(Argument(expression(random, below), name))
                    seen.add(name)
            return Call(random.choice((Name("limit"), own("servo").field("calculate"), Name("max"))), tuple(arguments))
        case 7:
            return tuple_of(expression(random, below) for _ in range(random.randint(1, 3)))
        case 8:
            sign = random.choice(("-", "not "))
            return Prefix(sign, at_least(expression(random, below), SIGN if sign == "-" else NOT))
        case 9:
            named = Parenthesized(Named("x1", expression(random, below)))
            return infix("<", COMPARISON, named, expression(random, below))
    return random.choice(NAMES)


def a_statement(random: random.Random) -> Statement:
    code = expression(random, random.randint(1, 4))
    match random.randrange(9):
        case 0:
            return return_(code)
        case 1:
            return if_(code, PASS)
        case 2:
            return run(awaited(own("control").call("write", code)))
        case 3:
            targets = (Name("k1_pan_angle"), Name("k1_pan_speed"))
            return Unpack(targets, own("_derivatives").called(code))
        case 4:
            return assign(own("made"), Items("[]", (code, expression(random, 2))))
        case 5:
            return return_(code, expression(random, 2))
        case 6:
            return assign("sample", delegated(own("control").call("read", code)))
    return assign(own("pan_torque"), code)


def reformatted(text: str) -> str:
    command = [sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", str(LINE_LENGTH), "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def test_breaks_where_the_formatter_does() -> None:
    source = random.Random(20)
    statements = [a_statement(source) for _ in range(1500)]
    written = [
        row
        for number, statement in enumerate(statements)
        for row in ("", "", f"async def function_{number}(self):", *lines([statement], "    "))
    ][2:]
    text = "\n".join(written) + "\n"
    assert reformatted(text) == text


@pytest.mark.parametrize("columns", [0, 80, 96, 97, 200])
def test_a_comment_stays_with_its_statement(columns: int) -> None:
    indent = " " * columns
    line = comment_line(indent, "position.csp:12  " + "limit(position) ; " * 20)
    assert line.startswith(f"{indent}# position.csp:12  limit(position)")
    assert line.endswith("...")


@pytest.mark.parametrize("columns", [12, 300])
def test_a_declaration_that_cannot_have_parentheses_is_split(columns: int) -> None:
    names = [f"variable_{number}" for number in range(30)]
    rows = lines(nonlocal_(names), " " * columns)
    assert [name for row in rows for name in row.strip().removeprefix("nonlocal ").split(", ")] == names
    assert all(row.startswith(" " * columns + "nonlocal ") for row in rows)
    assert all(len(row) <= max(LINE_LENGTH, columns + 20 + len("variable_29")) for row in rows)
