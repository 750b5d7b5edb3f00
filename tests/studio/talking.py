"""An engine to talk to in tests."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cspdiag.studio.engine.engine import Engine
from cspdiag.studio.engine.program_file import ProgramFile

MODELS = Path(__file__).parents[2] / "models"
JIWY = MODELS / "jiwy" / "jiwy.csp"


class Talk:
    """An engine, and its notifications; everything passes through JSON, as it does on the way to a page."""

    def __init__(self, file: ProgramFile | None = None) -> None:
        self.notifications: list[dict[str, Any]] = []
        self.engine = Engine(self._notify, file=file)

    def _notify(self, method: str, params: Callable[[], dict[str, Any]]) -> None:
        self.notifications.append(_through_json({"method": method, "params": params()}))

    def ask(self, method: str, **params: Any) -> Any:
        """The result of a request; what is refused fails the test."""
        answer = self.answer(method, **params)
        assert "error" not in answer, answer["error"]
        return answer["result"]

    def refused(self, method: str, **params: Any) -> str:
        """The message with which a request is refused."""
        message = self.answer(method, **params)["error"]["message"]
        assert isinstance(message, str)
        return message

    def answer(self, method: str, **params: Any) -> dict[str, Any]:
        """The answer to a request."""
        answer = _through_json(self.engine.request({"id": 7, "method": method, "params": _through_json(params)}))
        assert answer["id"] == 7
        return answer

    def model(self, name: str) -> dict[str, Any]:
        """One of the models that the engine has."""
        (found,) = [model for model in self.ask("hello")["models"] if model["name"] == name]
        return {"files": found["files"], "main": found["main"]}


def program(text: str) -> dict[str, Any]:
    """A program of one file."""
    return {"files": {"p.csp": text}, "main": "p.csp"}


def _through_json(message: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(message, allow_nan=False))
    return found
