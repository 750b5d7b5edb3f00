"""Text from outside the compiler, such as doc comments, strings, lines of the program and names of files, on its way
into other languages.

Each language has one module with a function for each place that such text may stand in, and nothing gets there past it:
``python_text`` and ``package_text`` (TOML and Markdown) beside this one, ``c/text`` and, for the languages of models,
``one_line``.
"""

from __future__ import annotations

from cspdiag.base.render.snippet import printable


def one_line(text: str) -> str:
    """``text`` on one line, with pictures for what cannot be seen: control characters, marks of writing direction, half
    characters.

    It ends no comment that goes to the end of its line, in any language.
    """
    return printable(" ".join(text.splitlines()))
