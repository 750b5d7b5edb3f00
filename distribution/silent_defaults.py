"""A ``match`` handles every case explicitly; ``make check`` reports defaults that are silent.

A default (``case _:``, or a name that takes all remaining cases) raises, preferably by ``assert_never``, or a comment
next to it says why the remaining cases may be anything: the nodes of a walk, or what a rewriting leaves as it is.

python distribution/silent_defaults.py
"""

from __future__ import annotations

import ast
import sys
import tokenize
from collections.abc import Iterator
from io import StringIO
from pathlib import Path

ROOT = Path(__file__).parent.parent


def complaints(root: Path) -> list[str]:
    """One line for each default below ``root`` that neither raises nor has a reason in a comment."""
    return [
        f"{path.relative_to(root).as_posix()}:{line}: the default is silent: name the cases that are left, and "
        "`assert_never` the rest, or say in a comment beside `case` why they may be anything"
        for path in sorted((root / "cspdiag").rglob("*.py"))
        for line in _silent_defaults(path.read_text(encoding="utf-8"))
    ]


def _silent_defaults(source: str) -> Iterator[int]:
    tokens = tokenize.generate_tokens(StringIO(source).readline)
    commented = {token.start[0] for token in tokens if token.type == tokenize.COMMENT}
    for part in ast.walk(ast.parse(source)):
        for case in part.cases if isinstance(part, ast.Match) else ():
            if _takes_everything(case) and not _raises(case.body[-1]):
                beginning = range(case.pattern.lineno, case.body[0].lineno + 1)
                if commented.isdisjoint(beginning):
                    yield case.pattern.lineno


def _takes_everything(case: ast.match_case) -> bool:
    return case.guard is None and isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None


def _raises(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        called = statement.value.func
        return isinstance(called, ast.Name) and called.id == "assert_never"
    return isinstance(statement, ast.Raise)


if __name__ == "__main__":
    found = complaints(ROOT)
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    sys.exit(bool(found))
