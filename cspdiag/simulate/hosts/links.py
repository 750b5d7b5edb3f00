"""Links to the other places: every message arrives once and in order, however often the network loses or delays it.

A frame numbers its messages, and acknowledges all messages of the other side up to a number. What is not acknowledged
is sent again, all of it in one frame. Places send a frame regularly, also without a message, and each says which frame
of the other side it answers. After each answer the next frame asks for another one: a place that has not answered it
after ``PATIENCE``, and the time that an answer takes, is lost until it does again. So both sides see that a link is
lost, even if it is in one direction, and neither loses it for a pause that is shorter.

A network may keep frames and bring them when it works again. Their messages are then not taken: they are sent again,
with all that has been said since.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Sequence
from secrets import token_hex
from typing import Any, Final, NamedTuple, Protocol

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.kernel.signals import left_to_the_main_thread
from cspdiag.runtime.real_time.jitter import Jitter
from cspdiag.simulate.hosts.messages import BadMessageError, Codec

PATIENCE: Final = 1.0
"""Seconds for which a place may be silent: it is lost after these and the time that an answer takes."""
_BEAT: Final = 0.1
"""Seconds after which a frame follows the last one, also without a message, at least, and one round trip."""
_SELDOM_BEAT: Final = 0.2
"""The longest such time."""
_BEAT_OF_LOST: Final = 0.25
"""Frames that wait in a slow network come before those that follow when it is back."""
_AGAIN: Final = 0.05
"""Seconds after which messages are sent again that have not been acknowledged, at least, and two round trips; twice as
long each further time.
"""
_SELDOM: Final = 0.4
"""The longest such time, or two round trips: a network that is slow must not get more to do than it can."""
_LOOK: Final = 0.02
_LONGEST_ANSWER: Final = 2 * _SELDOM_BEAT
"""Seconds that an answer may take: more than that is silence."""
LONGEST_SILENCE: Final = PATIENCE + _LONGEST_ANSWER
"""Seconds without an answer after which a place is lost, whatever the network."""


class PlaceError(CspdiagError):
    """The places of a program cannot run together; the message is one line."""


class DifferentProgramError(PlaceError):
    """Two places do not run the same."""


class Transport(Protocol):
    """Brings bytes to places, as a rule."""

    def open(self, place: str, arrived: Callable[[bytes], None]) -> None:
        """From now on ``arrived`` is called, in any thread, with what is sent to ``place``. Raises PlaceError."""
        ...

    def send(self, place: str, data: bytes) -> None:
        """Sends; what cannot be sent is lost."""
        ...

    def close(self) -> None:
        """Nothing arrives any more."""
        ...


class Frame(NamedTuple):
    """What is sent. ``instance`` is the process that has the place, ``known`` the one that it takes for the receiver;
    ``program`` says what it runs, unless the receiver knows, and ``begun`` whether it has found all places. ``number``
    is that of the first of ``messages``. ``stamp`` is its clock in nanoseconds; ``echo`` is that of the receiver when
    it sent the last frame that arrived, and since when it is here. Each message is written once, when it is sent first:
    sending it again needs no type of the program, which may have ended by then.
    """

    place: str
    instance: str
    known: str
    program: tuple[tuple[str, str], ...]
    begun: bool
    number: int
    acknowledged: int
    stamp: int
    echo: tuple[int, int]
    messages: tuple[bytes, ...]


class Link:
    """What is known of another place; ``round_trips`` are the times to it and back."""

    def __init__(self, place: str) -> None:
        self.place = place
        self.instance = ""
        self.knows = ""
        """The process that the other place takes for this one."""
        self.answered = 0.0
        """When the last frame was sent that it has answered, in seconds of this clock."""
        self.asked: float | None = None
        """When the first frame was sent after the last answer came: the next answer is to that one, or a later one."""
        self.sent = 0.0
        self.number = 0
        self.received = 0
        self.waiting: deque[tuple[int, bytes]] = deque()
        self.since = 0.0
        """When the first message that waits for its acknowledgement was last sent."""
        self.pause = _AGAIN
        """Seconds after which it is sent again."""
        self.recent = 0.0
        """The recent round trips, in seconds: a mean in which each one counts for an eighth."""
        self.echo = (0, 0)
        self.measured = 0
        """The stamp of the last frame whose round trip was measured."""
        self.lost = False
        self.over = False
        """Whether the other place has said that it has ended."""
        self.losses = 0
        self.round_trips = Jitter()

    def passed(self, round_trip: int) -> None:
        """A frame and its answer have taken that long, in nanoseconds."""
        self.round_trips.add(round_trip)
        self.recent += (round_trip / 1e9 - self.recent) / 8

    @property
    def shortest_pause(self) -> float:
        """The pause before messages are sent again for the first time."""
        return max(_AGAIN, 2 * self.recent)

    @property
    def beat(self) -> float:
        """Seconds after which a frame follows the last one."""
        return min(max(_BEAT, self.recent), _SELDOM_BEAT)

    @property
    def longest_silence(self) -> float:
        """Seconds after which it is lost if it has not answered: after ``PATIENCE`` comes the next beat and its answer,
        and the frame that asks may have been sent a little before the answers stopped.
        """
        return PATIENCE + min(self.beat + 2 * (_LOOK + self.recent), _LONGEST_ANSWER)

    def is_silent(self, now: float) -> bool:
        """Whether it has had the time to answer, and has not."""
        return self.asked is not None and now - self.asked > self.longest_silence

    def lengthen_pause(self) -> None:
        """They are sent again."""
        self.pause = max(min(2 * self.pause, _SELDOM), self.shortest_pause)


class Links:
    """The links of a place to all others. ``news`` is called, in any thread, when a message has arrived, and regularly
    while a place is lost.
    """

    def __init__(
        self, transport: Transport, codec: Codec, place: str, others: Sequence[str], program: dict[str, str]
    ) -> None:
        self.place = place
        self.by_place = {other: Link(other) for other in others}
        self.inbox: deque[tuple[str, Any]] = deque()
        self.news: Callable[[], None] = lambda: None
        self.begun = False
        """Whether all places are there: no other process may have one from now on."""
        self.problem: PlaceError | None = None
        """Why the places cannot run together."""
        self._instance = token_hex(8)
        self._program = tuple(program.items())
        self._transport = transport
        self._codec = codec
        self._changed = threading.Condition(threading.RLock())
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._keep_up, name="links to other places", daemon=True)

    def open(self) -> None:
        """Begins to look for the other places. Raises PlaceError."""
        self._transport.open(self.place, self._arrived)
        with left_to_the_main_thread():
            self._thread.start()

    def wait(self, seconds: float) -> None:
        """Waits until something has arrived, but no longer than that."""
        with self._changed:
            if not self.inbox and self.problem is None:
                self._changed.wait(seconds)

    @property
    def missing(self) -> list[str]:
        """The places that have not been found yet."""
        with self._changed:
            return [link.place for link in self.by_place.values() if link.knows != self._instance or not link.instance]

    @property
    def lost(self) -> list[Link]:
        """The places that are silent now."""
        return [link for link in self.by_place.values() if link.lost and not link.over]

    def send(self, place: str, message: Any) -> None:
        """Sends a message, which arrives when the link allows it."""
        link = self.by_place[place]
        written = self._codec.written(message)
        with self._changed:
            link.number += 1
            link.waiting.append((link.number, written))
            if len(link.waiting) == 1:
                link.since, link.pause = time.monotonic(), link.shortest_pause
            if not link.lost:
                self._transmit(link, [(link.number, written)])

    def broadcast(self, message: Any) -> None:
        """Sends a message to all other places."""
        for place in self.by_place:
            self.send(place, message)

    def report(self) -> list[str]:
        """What was measured, a line for each link."""
        lines = []
        for link in self.by_place.values():
            losses = f", lost {link.losses} {'time' if link.losses == 1 else 'times'}" if link.losses else ""
            lines.append(f"round trip to {link.place}: {link.round_trips}{losses}")
        return lines

    def close(self, patience: float = 0.5) -> None:
        """Waits, but not for long, until all messages have arrived, and leaves."""
        until = time.monotonic() + patience
        while time.monotonic() < until and any(
            link.waiting and not link.lost and link.instance for link in self.by_place.values()
        ):
            time.sleep(_LOOK / 2)
        self._closed.set()
        if self._thread.is_alive():
            self._thread.join()
        self._transport.close()

    def _transmit(self, link: Link, numbered: Collection[tuple[int, bytes]] = ()) -> None:
        now = time.monotonic_ns()
        link.sent = now / 1e9
        if link.instance and link.asked is None:
            link.asked = link.sent
        received, since = link.echo
        echo = (received, now - since)
        numbers, messages = zip(*numbered, strict=True) if numbered else ((0,), ())
        frame = Frame(
            place=self.place,
            instance=self._instance,
            known=link.instance,
            program=() if link.knows == self._instance else self._program,
            begun=self.begun,
            number=numbers[0],
            acknowledged=link.received,
            stamp=now,
            echo=echo,
            messages=messages,
        )
        self._transport.send(link.place, self._codec.written(tuple(frame)))

    def _keep_up(self) -> None:
        while not self._closed.wait(_LOOK):
            with self._changed:
                for link in self.by_place.values():
                    self._keep_up_with(link, time.monotonic())
            if self.lost:
                self.news()

    def _keep_up_with(self, link: Link, now: float) -> None:
        silent = link.instance and not link.over and link.is_silent(now)
        if silent and not self.begun:
            link.instance = link.knows = ""  # Another process may have the place.
        elif silent and not link.lost:
            link.lost = True
            link.losses += 1
            self._changed.notify_all()
        if link.waiting and not link.lost and now - link.since > link.pause:
            self._repeat(link, now)
        elif now - link.sent > (_BEAT_OF_LOST if link.lost else link.beat):
            self._transmit(link)

    def _repeat(self, link: Link, now: float) -> None:
        """Sends again what waits."""
        link.since = now
        link.lengthen_pause()
        self._transmit(link, link.waiting)

    def _arrived(self, data: bytes) -> None:
        now = time.monotonic_ns()
        try:
            frame = Frame(*self._codec.read(data))
            messages = [self._codec.read(message) for message in frame.messages]
        except (BadMessageError, TypeError):
            return  # It is from something else than a place of the program.
        link = self.by_place.get(frame.place)
        if link is None:
            if frame.place == self.place and frame.instance != self._instance:
                self._fail(PlaceError(f"another process has the place `{self.place}`, too"))
            return
        with self._changed:
            if self._is_partner(link, frame):
                self._take(link, frame, messages, now)
            self._changed.notify_all()
        self.news()

    def _is_partner(self, link: Link, frame: Frame) -> bool:
        """Whether a frame comes from the process that has the place, and is for this one."""
        if frame.program and frame.program != self._program:
            self._transmit(link)  # So that the other place sees the difference, too, before this one leaves.
            difference = _difference(frame.place, dict(self._program), dict(frame.program))
            self._fail(DifferentProgramError(difference))
            return False
        if frame.known not in ("", self._instance):
            if link.knows != self._instance:
                self._fail(PlaceError(_taken(self.place, begun=frame.begun)))
            return False
        if link.instance and frame.instance != link.instance:
            self._transmit(link)  # Which reports to it that another process has its place.
            return False
        if not link.instance:
            link.instance, link.echo, link.asked = frame.instance, (0, 0), None
        return True

    def _take(self, link: Link, frame: Frame, messages: list[Any], now: int) -> None:
        if frame.known:
            link.knows = frame.known
        answered, held = frame.echo if frame.known == self._instance else (0, 0)
        if answered and answered != link.measured:
            link.measured = answered
            link.passed(max(0, now - answered - held))
        if link.asked is not None and answered / 1e9 >= link.asked:
            link.asked = None
        ends_pause = now - link.echo[1] > 2 * link.beat * 1e9
        if frame.stamp > link.echo[0]:
            link.echo = (frame.stamp, now)
        sent = answered or now
        link.answered = max(link.answered, sent / 1e9)
        is_late = now - sent > link.longest_silence * 1e9
        self._acknowledged(link, frame.acknowledged, now / 1e9)
        if link.lost and not is_late:
            link.lost = False
            if link.waiting:
                self._repeat(link, now / 1e9)
        if messages and not is_late:
            if frame.number <= link.received + 1:
                new = messages[link.received + 1 - frame.number :]
                link.received += len(new)
                self.inbox.extend([(link.place, message) for message in new])  # At once, as they belong together.
            self._transmit(link)
        elif ends_pause:
            self._transmit(link)  # So that no more of the other's patience is used up.

    def _acknowledged(self, link: Link, number: int, now: float) -> None:
        """All messages up to a number have arrived."""
        while link.waiting and link.waiting[0][0] <= number:
            link.waiting.popleft()
            link.since, link.pause = now, link.shortest_pause

    def _fail(self, problem: PlaceError) -> None:
        if self.problem is None:
            self.problem = problem
        with self._changed:
            self._changed.notify_all()


def _taken(place: str, *, begun: bool) -> str:
    if begun:
        return f"the run has begun with another process in the place `{place}`, which none can replace: start all again"
    return f"another process has the place `{place}`, or had it a second ago"


def _difference(other: str, own: dict[str, str], theirs: dict[str, str]) -> str:
    for what, value in own.items():
        if theirs.get(what) != value:
            shown = f": here {value}, there {theirs.get(what)}" if what != "program" else ""
            return f"the place `{other}` has another {what}{shown}; start all places with the same files and options"
    return f"the place `{other}` runs another version of cspdiag"
