"""What the viewers of one program share: its engines, the run that they see, and who has the hand.

Questions about a text, work that may take minutes, and the program that runs each have an engine of their own, so that
none waits for another. One viewer has the hand: it alone starts, steers and stops the program. If it goes, the program
is stopped, because nobody is at the stick.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from cspdiag.studio.server.engines import EngineGoneError, EngineNotStartedError, EngineProcess
from cspdiag.studio.server.refusal import RefusedError
from cspdiag.studio.server.saved_files import SavedFiles
from cspdiag.studio.server.viewer import Viewer

QUESTIONS = frozenset({"hello", "check", "complete", "hover", "definition", "format", "draw", "explain"})
WORK = frozenset({"verify", "timing", "margins", "compile", "run"})
CONTROL = frozenset({"start", "play", "pause", "step", "input", "tune", "stop"})

PATIENCE_TO_STOP = 3.0
"""Seconds in which a program stops; after that, its engine is ended."""
BETWEEN_LOOKS = 0.5
"""Seconds between two looks at the files on disk."""
MOST_PENDING = 100
"""Requests of one viewer that may wait for their answers."""


class Room:
    """Answers the requests of viewers."""

    def __init__(self, command: Sequence[str], files: SavedFiles) -> None:
        self._command = command
        self._files = files
        self.viewers: list[Viewer] = []
        self._pages = 0
        self._hand: Viewer | None = None
        self._questions = EngineProcess(command, files.command_folder)
        self._work = EngineProcess(command, files.command_folder)
        self._session = self._new_session()
        self._running: dict[str, Any] | None = None
        self._looking: asyncio.Task[None] | None = None
        self._own: dict[str, Callable[[Viewer, Any], Any]] = {
            "take_hand": self._take_hand,
            "cancel": self._cancel,
            "save": self._save,
        }

    def enter(self, viewer: Viewer) -> None:
        """A page was opened; the first one has the hand."""
        self.viewers.append(viewer)
        self._pages += 1
        viewer.page = self._pages
        if self._hand is None:
            self._hand = viewer
        self._send_hand()
        if self._looking is None:
            self._looking = asyncio.create_task(self._look())

    async def leave(self, viewer: Viewer) -> None:
        """A page is gone. If it had the hand, the program is stopped, and the page that is open longest has it."""
        self.viewers.remove(viewer)
        if self._hand is viewer:
            self._hand = self.viewers[0] if self.viewers else None
            await self._end_session("the page that controlled it was closed, or its connection was lost")
        self._send_hand()
        if not self.viewers:
            self._look_no_more()

    async def close(self) -> None:
        """The server ends: the program is stopped, and its outputs are released."""
        self._look_no_more()
        await self._session.end()
        await self._questions.end()
        await self._work.end()

    async def _look(self) -> None:
        """Notify all pages when files of the program have changed on disk."""
        while True:
            await asyncio.sleep(BETWEEN_LOOKS)
            if self._files.look():
                self._files.note()
                with suppress(RefusedError):  # A file that cannot be read at present.
                    program = (await self._ask(self._questions, "hello", {}))["program"]
                    self._files.opened(program)
                    for viewer in self.viewers:
                        viewer.send({"method": "on_disk", "params": program})

    def _look_no_more(self) -> None:
        looking, self._looking = self._looking, None
        if looking is not None:
            looking.cancel()

    async def answer(self, viewer: Viewer, method: str, params: Any) -> Any:
        """The result of a request. Raises RefusedError."""
        if viewer.pending > MOST_PENDING:
            raise RefusedError("too many requests wait for their answers")
        if method in self._own:
            return await self._own[method](viewer, params)
        if method in CONTROL and viewer is not self._hand:
            raise RefusedError("another page controls the program", help="take control first")
        if method == "stop":
            return await self._stop(params)
        result = await self._ask(self._engine(method), method, params)
        if method == "hello":
            able = {**result.get("able", {}), "save": True}
            result = {**result, "able": able, **self._hand_of(viewer)}
            self._files.opened(result["program"])
            if self._running is not None:
                result["running"] = self._running
        if method == "start":
            self._started(viewer, params, result)
        return result

    async def _stop(self, params: Any) -> Any:
        """Stop the program, even one of which a process computes without end."""
        try:
            return await asyncio.wait_for(self._ask(self._session, "stop", params), PATIENCE_TO_STOP)
        except TimeoutError:
            why = f"one of its processes has computed for {PATIENCE_TO_STOP:g} s without a communication"
            await self._end_session(why)
            return {}

    def _engine(self, method: str) -> EngineProcess:
        if method in QUESTIONS:
            return self._questions
        if method in WORK:
            return self._work
        if method in CONTROL or method == "state":
            return self._session
        raise RefusedError("there is no such method")

    async def _ask(self, engine: EngineProcess, method: str, params: Any) -> Any:
        try:
            message = await engine.request(method, params)
        except EngineGoneError:
            raise RefusedError(
                "the engine has ended before it answered", help="ask again: another one begins"
            ) from None
        except EngineNotStartedError as problem:
            raise RefusedError(f"no process can be started for the engine: {problem}") from None
        if "error" in message:
            error = message["error"]
            raise RefusedError(error.get("message", "unknown"), error.get("help"))
        return message["result"]

    def _new_session(self) -> EngineProcess:
        return EngineProcess(
            self._command, self._files.command_folder, self._notify, self._session_gone, uses_terminal=True
        )

    def _notify(self, text: str, message: dict[str, Any]) -> None:
        """Passes a notification of the session on to all pages."""
        method = message["method"]
        if method == "ended":
            self._running = None
        for viewer in self.viewers:
            if method == "frame":
                viewer.send_frame(text, message["params"])
            else:
                viewer.send(text)

    def _started(self, hand: Viewer, params: Any, result: dict[str, Any]) -> None:
        program = {key: params[key] for key in ("files", "main", "own") if key in params}
        self._running = {**program, **result}
        for viewer in self.viewers:
            if viewer is not hand:
                viewer.send({"method": "started", "params": self._running})

    async def _end_session(self, why: str) -> None:
        running, self._running = self._running, None
        session, self._session = self._session, self._new_session()
        await session.end()
        self._send_end(running, "stopped", f"stopped: {why}")

    def _session_gone(self) -> None:
        """The engine of the running program has ended by itself."""
        running, self._running = self._running, None
        self._send_end(running, "fault", "the engine that ran the program has ended; the terminal may say why")

    def _send_end(self, running: dict[str, Any] | None, reason: str, text: str) -> None:
        if running is not None:
            ended = {"session": running["session"], "at": None, "reason": reason, "text": text, "waiting": []}
            for viewer in self.viewers:
                viewer.send({"method": "ended", "params": ended})

    async def _take_hand(self, viewer: Viewer, params: Any) -> dict[str, Any]:
        self._hand = viewer
        self._send_hand()
        return {}

    async def _cancel(self, viewer: Viewer, params: Any) -> dict[str, Any]:
        await self._work.end()
        return {}

    async def _save(self, viewer: Viewer, params: Any) -> dict[str, Any]:
        self._files.save(params.get("file"), params.get("text"), params.get("before"))
        return {}

    def _hand_of(self, viewer: Viewer) -> dict[str, Any]:
        held_by = None if self._hand is None else self._hand.page
        return {"hand": viewer is self._hand, "page": viewer.page, "held_by": held_by, "viewers": len(self.viewers)}

    def _send_hand(self) -> None:
        for viewer in self.viewers:
            viewer.send({"method": "hand", "params": self._hand_of(viewer)})
