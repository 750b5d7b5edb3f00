"""Long statements break over lines exactly where ``ruff format`` breaks them."""

from __future__ import annotations

import random
import subprocess
import sys

from cspdiag.codegen.python.text.code import (
    COMPARISON,
    NOT,
    OR,
    PRODUCT,
    SIGN,
    SUM,
    Argument,
    Atom,
    Call,
    Code,
    Conditional,
    Items,
    Named,
    Parenthesized,
    Prefix,
    at_least,
    infix,
    tuple_of,
)
from cspdiag.codegen.python.text.layout import LINE_LENGTH
from cspdiag.codegen.python.text.statements import Block, Line, Statement, Unpack, assign, lines, run

NAMES = ("x", "pan_angle", "self.stiffness", "joystick_horizontal", "k1_pan_motor_speed", "0.5", "h")


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
            return Call(random.choice(("limit", "self.servo.calculate", "max")), tuple(arguments))
        case 7:
            return tuple_of(expression(random, below) for _ in range(random.randint(1, 3)))
        case 8:
            sign = random.choice(("-", "not "))
            return Prefix(sign, at_least(expression(random, below), SIGN if sign == "-" else NOT))
        case 9:
            named = Parenthesized(Named("x1", expression(random, below)))
            return infix("<", COMPARISON, named, expression(random, below))
    return Atom(random.choice(NAMES))


def a_statement(random: random.Random) -> Statement:
    code = expression(random, random.randint(1, 4))
    match random.randrange(7):
        case 0:
            return Line("return ", code)
        case 1:
            return Block(Line("if ", code, ":"), (Line("pass"),))
        case 2:
            return run(Prefix("await ", Call("self.control.write", (Argument(code),))))
        case 3:
            return Unpack(("k1_pan_angle", "k1_pan_speed"), Call("self._derivatives", (Argument(code),)))
        case 4:
            return assign("self.made", Items("[]", (code, expression(random, 2))))
    return assign("self.pan_torque", code)


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
