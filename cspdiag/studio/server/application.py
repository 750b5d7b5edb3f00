"""The application: the files of the page, and a WebSocket through which it reaches the engines."""

from __future__ import annotations

import asyncio
import json
from html import escape
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from cspdiag.studio.server.access import Access, SingleUse
from cspdiag.studio.server.refusal import RefusedError
from cspdiag.studio.server.room import Room
from cspdiag.studio.server.viewer import Viewer

_HEADERS = {
    "Cache-Control": "no-cache",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""The link has the token, so no other page may learn it; and no page may show this one in a frame."""

_POLICY_VIOLATION = 1008
_SEEN = "seen"
_PING = "ping"


def application(room: Room, access: Access, first: SingleUse, page: Path) -> Starlette:
    """What a server of ASGI runs; ``page`` is the folder with the files of the page."""

    async def opened(request: Request) -> Response:
        if first.use(request.query_params.get("once", "")):
            return RedirectResponse(f"/?token={access.token}", 303)
        return _refused("This link was used before. The terminal shows one that can be used again.")

    async def page_of_link(request: Request) -> Response:
        if access.knows_token(request.query_params.get("token", "")):
            return FileResponse(page / "index.html")
        return _refused(
            "This is not the link of the studio that runs now: each start has a new one. Open the link that is in the "
            "terminal in which `cspdiag studio` runs, and copy it as a whole."
        )

    async def engine(socket: WebSocket) -> None:
        allowed = access.knows_host(socket.headers) and access.knows_origin(socket.headers)
        if not allowed or not access.knows_token(socket.query_params.get("token", "")):
            await socket.close(_POLICY_VIOLATION)
            return
        await socket.accept()
        await _serve(socket, room)

    routes = [
        WebSocketRoute("/engine", engine),
        Route("/open", opened),
        Route("/", page_of_link),
        Route("/index.html", page_of_link),
        Mount("/", StaticFiles(directory=page, html=True)),
    ]
    guard = Middleware(_GuardedFiles, access=access)
    return Starlette(routes=routes, middleware=[guard])


def _refused(reason: str) -> Response:
    """A page that says why there is no studio, and what to do."""
    style = "font: 16px/1.5 system-ui, sans-serif; max-width: 34em; margin: 15vh auto; padding: 0 1em"
    return HTMLResponse(
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f'<meta name="color-scheme" content="light dark"><title>cspdiag studio</title>'
        f'<body style="{style}"><h1>cspdiag studio</h1><p>{escape(reason)}</p></body></html>',
        403,
    )


class _GuardedFiles:
    """Answers requests for files that name this server, with headers that keep other pages away."""

    def __init__(self, application: ASGIApp, access: Access) -> None:
        self._application = application
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._application(scope, receive, send)
            return

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        known = self._access.knows_host(Headers(scope=scope))
        answer = self._application if known else PlainTextResponse("this is not the host of the studio", 421)
        await answer(scope, receive, send_guarded)


async def _serve(socket: WebSocket, room: Room) -> None:
    """Answer a page until it goes."""
    viewer = Viewer(socket)
    room.enter(viewer)
    sending = asyncio.create_task(viewer.send_all())
    answering: set[asyncio.Task[None]] = set()
    try:
        while True:
            received = await socket.receive()
            if received["type"] == "websocket.disconnect":
                break
            task = asyncio.create_task(_answer(viewer, room, received.get("text")))
            answering.add(task)
            task.add_done_callback(answering.discard)
    finally:
        sending.cancel()
        for task in answering:
            task.cancel()
        await room.leave(viewer)


async def _answer(viewer: Viewer, room: Room, text: str | None) -> None:
    number, method, params = _parsed(text)
    if method == _SEEN:
        viewer.seen()
        return
    if method == _PING:
        viewer.send({"method": "pong", "params": {}})
        return
    viewer.pending += 1
    try:
        if method is None:
            raise RefusedError("a message is a JSON object with `id`, `method` and `params`")
        viewer.send({"id": number, "result": await room.answer(viewer, method, params)})
    except RefusedError as refused:
        viewer.send({"id": number, "error": refused.as_data()})
    except Exception as problem:  # The page must not wait for an answer that never comes.
        failed = RefusedError(
            f"cspdiag failed: {type(problem).__name__}: {problem}", "please report it: this is a mistake in cspdiag"
        )
        viewer.send({"id": number, "error": failed.as_data()})
    finally:
        viewer.pending -= 1


def _parsed(text: str | None) -> tuple[Any, str | None, dict[str, Any]]:
    """The number, the method and the parameters of a request; without a method if it is none. What a page says of its
    connection has no number: that it has seen a frame, and a ping.
    """
    try:
        message = json.loads(text or "")
    except (ValueError, RecursionError):
        return None, None, {}
    if message in ({"method": _SEEN}, {"method": _PING}):
        return None, message["method"], {}
    if not isinstance(message, dict) or not isinstance(message.get("id"), int | str):
        return None, None, {}
    method, params = message.get("method"), message.get("params", {})
    if not isinstance(method, str) or not isinstance(params, dict):
        return message["id"], None, {}
    return message["id"], method, params
