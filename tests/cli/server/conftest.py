from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from cspdiag.cli.server.place import AVAILABLE
from tests.cli.server.commands import Place, served


@pytest.fixture
def alone(tmp_path: Path) -> Place:
    """A place without a server."""
    if not AVAILABLE:
        pytest.skip("this system has no servers")
    return Place(tmp_path)


@pytest.fixture
def place(alone: Place) -> Iterator[Place]:
    """A place with a server."""
    with served(alone):
        yield alone
