"""Trees of compositions as text, so that a program that shows a difference can be made smaller."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Node:
    """A composition, as an operand: ``form`` with a ``{}`` for each child, or the children joined by ``operator`` if
    there is one.
    """

    form: str = "skip"
    children: tuple[Node, ...] = ()
    operator: str = ""
    guarded: bool = False
    """A guarded process, which can be removed but not replaced by one of its parts."""

    def __str__(self) -> str:
        if not self.operator:
            return self.form.format(*self.children)
        inner = self.operator.join(map(str, self.children))
        return f"({inner})" if len(self.children) > 1 else inner

    def size(self) -> int:
        """The number of nodes."""
        return 1 + sum(child.size() for child in self.children)

    def smaller(self) -> Iterator[Node]:
        """Smaller trees, the smallest first: nothing, a part, one with a smaller part."""
        if not self.guarded:
            if self.form != "skip":
                yield Node()
            yield from (child for child in self.children if not child.guarded)
        if self.operator and len(self.children) > 1:
            for gone in range(len(self.children)):
                yield replace(self, children=self.children[:gone] + self.children[gone + 1 :])
        for index, child in enumerate(self.children):
            for other in child.smaller():
                yield replace(self, children=(*self.children[:index], other, *self.children[index + 1 :]))


@dataclass(frozen=True)
class Program:
    """Processes by name with their declarations and compositions, and the rest of the text: what comes ``before`` and
    ``after`` them.
    """

    before: str
    leaves: tuple[tuple[str, str, Node], ...]
    after: str
    top: Node = field(default_factory=Node)
    """The composition of the outermost process; its text replaces ``{top}`` in ``after``."""

    def __str__(self) -> str:
        processes = [
            f"process {name} {{\n{declared}\n  composition {{\n    {body}\n  }}\n}}\n"
            for name, declared, body in self.leaves
        ]
        return "\n".join([self.before, *processes, self.after.replace("{top}", str(self.top))])

    def smaller(self) -> Iterator[Program]:
        """Programs with a smaller composition."""
        for index, (name, declared, body) in sorted(enumerate(self.leaves), key=lambda entry: -entry[1][2].size()):
            for other in body.smaller():
                leaves = (*self.leaves[:index], (name, declared, other), *self.leaves[index + 1 :])
                yield replace(self, leaves=leaves)
        for other in self.top.smaller():
            yield replace(self, top=other)
