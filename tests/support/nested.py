"""Programs in which one form is nested in itself, as deeply as requested."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from cspdiag.network.analyse import DEEPEST_PROCESSES

_INNERMOST = "(o ! n ; n := n + 1)"

_WRAPPED: Mapping[str, str] = {
    "mu": "(mu {inner} until n > 2)",
    "while": "(while n < 3 do {inner})",
    "if": "(if n < 3 then {inner} else o ! -1)",
    "seq": "(seq i{level} < 1 : {inner})",
    "catch": "({inner} catch Ex -> o ! -1)",
    "handler": "((o ! n ; n := n + 1 ; raise Ex) catch Ex -> {inner})",
    "alternative": "(skip -> {inner} [] after 1 ms -> o ! -1)",
    "group": "(part: {inner})",
    "interrupt": "({inner} interrupt after 1 s -> o ! -1)",
    "parallel": "({inner} || wait 1 ms)",
}
"""A composition around another one."""


def nested(form: str, depth: int) -> str:
    """A program with ``depth`` levels of one form, which ends after a few communications of ``o``."""
    return _MADE[form](depth) if form in _MADE else _program(_around(_INNERMOST, [form] * depth))


def _around(body: str, forms: list[str]) -> str:
    for level, form in enumerate(forms):
        body = _WRAPPED[form].format(inner=body, level=level)
    return body


def _program(body: str) -> str:
    return f"""exception Ex
process Nested {{
  out o : int
  communication {{ var n : int = 0 }}
  composition {{ {body} }}
}}
environment Bench for Nested {{ o -> _ }}
"""


def _mixed(depth: int) -> str:
    forms = sorted(_WRAPPED.keys() - {"handler"})
    return _program(_around(_INNERMOST, [forms[level % len(forms)] for level in range(depth)]))


def _ready(depth: int) -> str:
    """Alternatives in which every guard is ready, and no branch waits."""
    body = "n := n + 1"
    for _ in range(depth):
        body = f"(skip -> {body} []> skip -> skip)"
    return _program(f"{body} ; o ! n")


def _instances(composition: str) -> Callable[[int], str]:
    """Processes each with an instance ``p`` of the previous one."""

    def text(depth: int) -> str:
        processes = [
            f"""process P{level} {{
  out o : int
  communication {{ p : P{level - 1} p.o -> o var n : int = 0 }}
  composition {{ {composition} }}
}}"""
            for level in range(1, depth + 1)
        ]
        inner = "process P0 { out o : int composition { o ! 1 ; wait 1 ms ; raise Ex } }"
        end = f"environment Bench for P{depth} {{ o -> _ }}"
        return "\n".join(["exception Ex", inner, *processes, end, ""])

    return text


def _expression(form: str) -> Callable[[int], str]:
    def text(depth: int) -> str:
        value = "n"
        for _ in range(depth):
            value = form.format(value)
        return _program(f"(mu (o ! {value} ; n := n + 1) until n > 2)")

    return text


_MADE: Mapping[str, Callable[[int], str]] = {
    "mixed": _mixed,
    "ready alternative": _ready,
    "instances": _instances("p ; n := n + 1 ; o ! n"),
    "instances in loops": _instances("n := 0 ; (mu (p catch Ex -> n := n + 1) until n == 1) ; raise Ex"),
    "instances in alternatives": _instances("(mu (skip -> p [] after 1 ms -> o ! n) until n == 0)"),
    "conditional": _expression("(if n < 3 then 1 - {} else n)"),
    "maximum": _expression("max(0, {})"),
    "product": _expression("({} * 2)"),
    "absolute value": _expression("abs({})"),
}

FORMS = (*_WRAPPED, *_MADE)

_DEEPEST: Mapping[str, int] = {"alternative": 98, "mixed": 150, "ready alternative": 98, "conditional": 98}


def deepest(form: str) -> int:
    """The numbers of levels of a form that programs are tried with: about as many as ``check`` accepts, or fewer if
    each level is a process or a branch, which take time.
    """
    if form in ("interrupt", "parallel"):
        return 60
    if form.startswith("instances"):
        return DEEPEST_PROCESSES - 1
    return _DEEPEST.get(form, 190)
