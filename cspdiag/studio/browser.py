"""The engine for JavaScript: texts in, texts out (``studio/src/worker``)."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from cspdiag.draw.layout import engine as layout
from cspdiag.studio.engine.engine import Engine


class Functions:
    """What the worker calls. ``lay_out`` places a graph, as text, and ``notify`` takes notifications."""

    def __init__(self, lay_out: Callable[[str], str], notify: Callable[[str], object]) -> None:
        layout.use(lay_out)
        self._engine = Engine(
            lambda method, params: notify(_text({"method": method, "params": params()})), kind="browser"
        )

    def request(self, text: str) -> str:
        """The answer to a request."""
        return _text(self._engine.request(json.loads(text)))

    def due(self) -> float | None:
        """Seconds until ``proceed`` is to be called, None if nothing runs."""
        return self._engine.due()

    def proceed(self) -> None:
        """Let a program that plays run for a frame."""
        self._engine.proceed()


def _text(message: dict[str, Any]) -> str:
    return json.dumps(message, allow_nan=False)
