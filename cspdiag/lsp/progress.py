"""What takes long, as the editor shows it: with its title, and so that it can be cancelled there."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar
from uuid import uuid4

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer

T = TypeVar("T")

QUIETLY = 0.5
"""Seconds after which the editor shows that something is under way: what is shorter would only flicker."""


async def with_progress(server: LanguageServer, title: str, detail: str, work: Coroutine[Any, Any, T]) -> T:
    """Do some work, and show that it is being done if that takes long and the editor can show it.

    Raises CancelledError if it was cancelled in the editor.
    """
    task = asyncio.ensure_future(work)
    try:
        await asyncio.wait({task}, timeout=QUIETLY)
        window = server.client_capabilities.window
        if task.done() or window is None or not window.work_done_progress:
            return await task
        return await _shown(server, title, detail, task)
    finally:
        task.cancel()


async def _shown(server: LanguageServer, title: str, detail: str, task: asyncio.Future[T]) -> T:
    progress, token = server.work_done_progress, str(uuid4())
    try:
        await progress.create_async(token)
    except JsonRpcException:
        return await task  # An editor that cannot show it after all.
    # pygls cancels it when the editor asks for that.
    progress.tokens[token].add_done_callback(lambda _: task.cancel())
    progress.begin(token, types.WorkDoneProgressBegin(title, cancellable=True, message=detail))
    try:
        return await task
    finally:
        progress.end(token, types.WorkDoneProgressEnd())
        del progress.tokens[token]
