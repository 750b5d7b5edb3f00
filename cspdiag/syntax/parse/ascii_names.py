"""ASCII names for names in other alphabets."""

from __future__ import annotations

from contextlib import suppress

_SPELLED_OUT = dict(
    zip("äöüÄÖÜßæøåÆØÅ", ["ae", "oe", "ue", "Ae", "Oe", "Ue", "ss", "ae", "oe", "aa", "Ae", "Oe", "Aa"], strict=True)
)


def ascii_name(word: str) -> str | None:
    """An ASCII name for a name with other letters: ``groesse``, ``omega``; None if there is no obvious one."""
    letters = [ascii_letters(letter) for letter in word]
    found = "".join(letters)
    return found if all(letters) and found.isascii() and found.isidentifier() else None


def ascii_letters(letter: str) -> str:
    """The spelling of a letter of any alphabet in such a name; empty if there is nothing obvious."""
    from unicodedata import name, normalize

    plain = _SPELLED_OUT.get(letter) or "".join(part for part in normalize("NFKD", letter) if part.isascii())
    if not plain:
        with suppress(ValueError):
            # "GREEK SMALL LETTER OMEGA WITH TONOS" is an omega.
            plain = name(letter).partition(" LETTER ")[2].split(" ")[0].lower()
    return plain
