"""Descriptions of the states of a thread, in the words of the diagram."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.proofs.transitions.systems.references import Constant, Discard
from cspdiag.proofs.transitions.systems.system import Place
from cspdiag.proofs.transitions.systems.template import PlaceTemplate
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import ThreadInstance


class Places(Mapping[int, Place]):
    """The places of a thread by state, put into words when they are looked up."""

    def __init__(self, templates: list[PlaceTemplate], thread: ThreadInstance) -> None:
        self._templates = templates
        self._thread = thread

    def __getitem__(self, state: int) -> Place:
        if not 0 <= state < len(self._templates):
            raise KeyError(state)
        template = self._templates[state]
        path = ".".join((self._thread.occurrence.path, *template.path))
        if template.reference is None or isinstance(template.reference, Constant | Discard):
            return Place(template.words, template.span, path)
        medium = resolve(self._thread.occurrence, template.reference)
        return Place(f"{template.words} {_short(medium.name)}", template.span, path)

    def __iter__(self) -> Iterator[int]:
        return iter(range(len(self._templates)))

    def __len__(self) -> int:
        return len(self._templates)


def _short(name: str) -> str:
    """A hierarchical name without the outermost process."""
    return name.split(".", 1)[-1]
