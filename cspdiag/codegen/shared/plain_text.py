"""Text from outside the compiler, such as doc comments, strings, lines of the program and names of files, in other
languages.

Each language has one module with a function for each place where such text may occur, and all of it passes through
these functions: ``python_text`` and ``package_text`` (TOML and Markdown), ``c/text`` and, for the languages of models,
``one_line``.
"""

from __future__ import annotations

from cspdiag.base.render.snippet import printable


def one_line(text: str) -> str:
    """``text`` on one line, with pictures for what cannot be seen: control characters, marks of writing direction, lone
    surrogates.

    It cannot end a comment that extends to the end of its line, in any language.
    """
    return printable(" ".join(text.splitlines()))
