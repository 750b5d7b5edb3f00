"""The name that was probably meant."""

from __future__ import annotations

from collections.abc import Iterable

_LONGEST = 60


class Speller:
    """Finds similar names as long as that is quick: a text full of unknown names gets no more help than a person would
    read.
    """

    def __init__(self, comparisons: int = 100_000, measurements: int = 5_000) -> None:
        self._comparisons = comparisons
        self._measurements = measurements

    def nearest(self, name: str, candidates: Iterable[str]) -> str | None:
        """The candidate of which ``name`` is most likely a misspelling, or None: at most one edit in three letters."""
        if len(name) > _LONGEST:
            return None
        best: str | None = None
        least = 4
        lowered = name.lower()
        single = _with_single_letters(lowered)
        for candidate in candidates:
            self._comparisons -= 1
            if self._comparisons < 0 or self._measurements < 0:
                break
            differ = abs(len(candidate) - len(name))
            allowed = min(min(len(name), len(candidate)) // 3, least - 1)
            if differ == 1 < least and not allowed and _with_single_letters(candidate.lower()) == single:
                # A doubled letter is a slip even in the shortest name.
                best, least = candidate, 1
                continue
            if candidate == name or allowed < 0 or differ > allowed or len(candidate) < 2:
                continue
            self._measurements -= 1
            distance = edits(lowered, candidate.lower())
            if distance <= allowed:
                best, least = candidate, distance
                if distance == 0:
                    break
        return best


def is_slip(written: str, meant: str) -> bool:
    """Whether a name is certainly a misspelling of another one.

    That is a name in letters of another case, with two neighbours exchanged, or with a letter inside it lost or added.
    A digit, the first letter or the last often distinguish two things, and so does any letter in a short name.
    """
    if written.lower() == meant.lower():
        return len(meant) > 2
    shorter, longer = sorted((written, meant), key=len)
    if len(shorter) < 4:
        return False
    at = next((at for at, (a, b) in enumerate(zip(shorter, longer, strict=False)) if a != b), len(shorter))
    if len(shorter) == len(longer):
        exchanged = shorter[:at] + shorter[at + 1 : at + 2] + shorter[at] + shorter[at + 2 :]
        return exchanged == longer and shorter[at : at + 2].isalpha()
    return 0 < at < len(shorter) and shorter[at:] == longer[at + 1 :] and longer[at].isalpha()


def near_symbol(written: str, symbols: Iterable[str]) -> str | None:
    """The symbol of a unit that was probably meant: with a letter doubled, with neighbours exchanged, in the plural, or
    in letters of another case.

    A first letter in another case is another prefix (``mHz``, ``MHz``), and another letter another unit.
    """
    lowered = written.lower()
    doubled = [at for at in range(1, len(written)) if lowered[at] == lowered[at - 1]]
    meant = {written[:at] + written[at + 1 :] for at in doubled}
    meant |= {written[:at] + written[at : at + 2][::-1] + written[at + 2 :] for at in range(len(written) - 1)}
    if len(written) > 3:
        meant.add(written.removesuffix("s"))
    for symbol in symbols:
        in_other_case = lowered == symbol.lower() and written[1:] != symbol[1:]
        if len(symbol) > 1 and (symbol in meant or in_other_case):
            return symbol
    return None


def _with_single_letters(name: str) -> str:
    return "".join(letter for at, letter in enumerate(name) if not letter.isalpha() or letter != name[at - 1 : at])


def edits(left: str, right: str) -> int:
    """Insertions, deletions, replacements and swaps of neighbours (optimal string alignment)."""
    before: list[int] = []
    row = list(range(len(right) + 1))
    for i, a in enumerate(left, 1):
        earlier, before, row = before, row, [i]
        for j, b in enumerate(right, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (a != b))
            if i > 1 and j > 1 and a == right[j - 2] and left[i - 2] == b:
                cost = min(cost, earlier[j - 2] + 1)
            row.append(cost)
    return row[-1]
