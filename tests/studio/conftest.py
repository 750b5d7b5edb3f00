import pytest

from tests.studio.talking import Talk


@pytest.fixture
def talk() -> Talk:
    return Talk()
