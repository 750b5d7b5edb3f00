"""Which threads wait forever: the greatest set of threads of which every possible partner is in the set, or
has ended.
"""

from __future__ import annotations

from tests.oracle.machine.link import End, Linked
from tests.oracle.machine.state import Branches, Choice, Frame, Joint, Offer, Op, State, Stopped, Thread, Tid


def _later(linked: Linked, frame: Frame) -> tuple[frozenset[End], bool]:
    """What a frame may still do, and whether it may raise an exception."""
    node = linked.nodes[frame.node]
    match frame.kind:
        case "seq":
            rest = node.inner[frame.at :]
            return frozenset().union(*(part.uses for part in rest)), any(part.raises for part in rest)
        case "catch" | "intr":
            return node.inner[1].uses, node.inner[1].raises
        case _:
            return node.uses, node.raises


def future(linked: Linked, thread: Thread) -> tuple[frozenset[End], bool]:
    """Every end of a channel that a thread, or what it starts, may ever use from now on; and whether it may raise."""
    ends: frozenset[End] = frozenset()
    raises = False
    for frame in thread.stack:
        more, also = _later(linked, frame)
        ends, raises = ends | more, raises or also
    if thread.wait is None and thread.signal[0] in ("exec", "chosen"):
        number = thread.signal[1]
        assert isinstance(number, int)
        ends, raises = ends | linked.nodes[number].uses, raises or linked.nodes[number].raises
    if thread.wait is None and thread.signal[0] == "raise":
        raises = True
    return ends, raises


def _all_ends(linked: Linked, thread: Thread) -> frozenset[End]:
    """Every end that a thread uses anywhere, including places that it does not reach again."""
    if not thread.tid:
        return linked.root.uses
    number, branch = thread.tid[-1]
    return linked.nodes[number].inner[branch].uses


def stuck(linked: Linked, st: State, *, runs_on: bool = False) -> dict[Tid, Thread]:
    """The threads that never continue, in the state that was reached, without those that only wait at `stop`.

    `runs_on`: a thread that waits for a partner which runs on, but never again reaches what is waited for, is not in a
    knot.

    Threads that halt at `stop` and for which only their parents wait are left out. An exception that another process
    may raise ends the waiting; a missed sample or a fault is not counted on.
    """
    if st.ended is not None:
        return {}
    after = {tid: future(linked, thread) for tid, thread in st.threads.items()}
    if runs_on:
        after = {tid: (ends | _all_ends(linked, st.threads[tid]), raises) for tid, (ends, raises) in after.items()}
    found = {
        tid
        for tid, thread in st.threads.items()
        if isinstance(thread.wait, Joint | Choice | Stopped | Branches)
        and tid not in st.ready
        and tid != st.running
        and not thread.cancel
    }
    changed = True
    while changed:
        changed = False
        for tid in sorted(found):
            if _continues(linked, st, tid, found, after):
                found.discard(tid)
                changed = True
    if not any(waits_for_others(st.threads[tid]) for tid in found):
        return {}
    return {tid: st.threads[tid] for tid in found}


def waits_for_others(thread: Thread) -> bool:
    """Whether it waits neither at `stop` nor at an alternative without a true condition, which is equivalent
    to `stop`.
    """
    return isinstance(thread.wait, Joint) or (isinstance(thread.wait, Choice) and bool(thread.wait.offers))


def _continues(
    linked: Linked, st: State, tid: Tid, found: set[Tid], after: dict[Tid, tuple[frozenset[End], bool]]
) -> bool:
    thread = st.threads[tid]

    def partner(channel: str, end: str, branch: int | None = None) -> bool:
        partner_end = (channel, "!" if end == "?" else "?")
        return any(
            partner_end in ends and other not in found and (branch is None or st.threads[other].branch in (branch, -1))
            for other, (ends, _) in after.items()
        )

    def op_possible(op: Op) -> bool:
        if op.channel in linked.ports:
            return True
        if op.end == "!" and linked.channels[op.channel].kind == "broadcast":
            return all(partner(op.channel, "!", end) for end in op.pending)
        return partner(op.channel, op.end)

    def offer_possible(offer: Offer) -> bool:
        if offer.kind in ("after", "skip", "ready") or offer.channel in linked.ports:
            return True
        end = "?" if offer.kind == "read" else "!"
        if end == "!" and linked.channels[offer.channel].kind == "overwrite":
            return True
        return partner(offer.channel, end)

    for length in range(len(tid) + 1):
        for frame in st.threads[tid[:length]].stack:
            if frame.kind == "intr" and frame.offer is not None and offer_possible(frame.offer):
                return True
    for other, (_, raises) in after.items():
        related = other[: len(tid)] == tid or tid[: len(other)] == other
        if raises and other not in found and not related:
            return True
    match thread.wait:
        case Joint(ops):
            return all(op_possible(op) for op in ops if not op.done)
        case Choice(_, offers):
            return any(map(offer_possible, offers))
        case Branches(node, running, _, _):
            return not any((*tid, (node, branch)) in found for branch in running)
        case _:
            return False
