"""Random compositions of communications on one port, with the relation of every two determined by brute force."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import strategies as st


@dataclass(frozen=True)
class Leaf:
    """A communication: ``?`` or ``!`` on the channel in question."""

    kind: str


@dataclass(frozen=True)
class Node:
    """``;``, ``||``, ``[]`` or ``mu`` over parts."""

    operator: str
    parts: tuple[Leaf | Node, ...]


def trees(kinds: str) -> st.SearchStrategy[Leaf | Node]:
    """Compositions whose leaves are of the given kinds."""
    leaves = st.sampled_from(kinds).map(Leaf)
    return st.recursive(
        leaves,
        lambda inner: st.builds(
            Node,
            st.sampled_from([";", "||", "[]", "mu"]),
            st.lists(inner, min_size=2, max_size=3).map(tuple),
        ),
        max_leaves=8,
    )


def text_of(tree: Leaf | Node, numbered: list[Leaf]) -> str:
    """The composition as text; every leaf uses a variable of its own, so only the channel is shared."""
    if isinstance(tree, Leaf):
        numbered.append(tree)
        return f"c ? v{len(numbered) - 1}" if tree.kind == "?" else f"c ! {len(numbered)}"
    parts = [text_of(part, numbered) for part in tree.parts]
    if tree.operator == "[]":
        return "(" + " [] ".join(f"after {n + 1} ms -> {part}" for n, part in enumerate(parts)) + ")"
    if tree.operator == "mu":
        return "(" + " ; ".join(f"(mu {part} until true)" for part in parts) + ")"
    return "(" + f" {tree.operator} ".join(parts) + ")"


def relations(tree: Leaf | Node) -> set[tuple[str, str, str]]:
    """For every two different leaves: their kinds, in alphabetical order, and whether they are in parallel."""
    found: set[tuple[str, str, str]] = set()

    def leaves(part: Leaf | Node) -> list[str]:
        if isinstance(part, Leaf):
            return [part.kind]
        inside = [leaves(inner) for inner in part.parts]
        relation = "parallel" if part.operator == "||" else "sequence"
        for position, left in enumerate(inside):
            for right in inside[position + 1 :]:
                for one in left:
                    for other in right:
                        first, second = sorted((one, other))
                        found.add((first, second, relation))
        return [kind for group in inside for kind in group]

    leaves(tree)
    return found


def program(composition: str, leaves: int) -> str:
    """A process that does the composition on its channel ``c``."""
    variables = "".join(f"    var v{n} : int = 0\n" for n in range(leaves))
    return f"""process Main {{
  communication {{
    channel c : int
{variables}  }}
  composition {{ {composition} }}
}}
"""
