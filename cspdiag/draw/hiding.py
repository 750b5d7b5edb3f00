"""What a drawing leaves out on request."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.record import record

KINDS_OF_LABELS = ("labels", "types", "ports", "periods", "kinds", "legend")
"""Words that hide all labels of a sort: names of arrows, types, local names of ports, sample periods, kinds of
channels; and the legend.
"""


@record
class Hidden:
    """Labels by name (``leftmax``), and sorts of labels."""

    names: frozenset[str] = frozenset()

    def hides(self, sort: str, name: str = "") -> bool:
        """Whether all labels of a sort are hidden, or the one of this name."""
        return sort in self.names or (bool(name) and name in self.names)


NOTHING_HIDDEN = Hidden()
ALL_LABELS = Hidden(frozenset(KINDS_OF_LABELS) - {"legend"})


def hidden(words: Iterable[str]) -> Hidden:
    """The labels that comma-separated words hide; spaces around them do not count."""
    return Hidden(frozenset(word.strip() for given in words for word in given.split(",") if word.strip()))
