from __future__ import annotations

import sys
from collections.abc import AsyncIterator

import pytest_lsp
from lsprotocol import types
from pytest_lsp import ClientServerConfig, client_capabilities

from tests.lsp.editor import Client

SERVER = ClientServerConfig([sys.executable, "-m", "cspdiag", "lsp"], client_factory=Client)


@pytest_lsp.fixture(config=SERVER, scope="module")
async def client(lsp_client: Client) -> AsyncIterator[None]:
    """A server that is running, as a client sees it."""
    capabilities = client_capabilities("visual-studio-code")
    await lsp_client.initialize_session(types.InitializeParams(capabilities=capabilities))
    yield
    await lsp_client.shutdown_session()
