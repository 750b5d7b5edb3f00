"""``make check`` refuses a ``match`` with a silent default."""

from __future__ import annotations

from pathlib import Path

import pytest

from distribution.silent_defaults import ROOT, complaints


def _lines(root: Path, default: str) -> list[str]:
    (root / "cspdiag").mkdir(exist_ok=True)
    source = f"def f(action):\n    match action:\n        case Read():\n            return 1\n{default}\n    return 2\n"
    (root / "cspdiag/module.py").write_text(source)
    return complaints(root)


@pytest.mark.parametrize(
    "default",
    [
        "        case _:\n            pass",
        "        case _:\n            return 3",
        "        case other:\n            return other",
        "        case _:\n            if action:\n                raise AssertionError(action)",
        '        case _:\n            return "#"',
    ],
)
def test_a_silent_default_is_reported(tmp_path: Path, default: str) -> None:
    (line,) = _lines(tmp_path, default)
    assert line.startswith("cspdiag/module.py:5: ")


@pytest.mark.parametrize(
    "default",
    [
        "        case _:\n            assert_never(action)",
        "        case _:\n            raise AssertionError(action)",
        "        case Write():\n            pass",
        "        case _ if action:\n            pass",
        "        case _:  # Any other node of the walk.\n            pass",
        "        case _:\n            pass  # Nothing else has a size.",
        "        case _:\n            # Nothing else has a size.\n            return 3",
    ],
)
def test_a_default_that_raises_or_has_a_reason_is_left_alone(tmp_path: Path, default: str) -> None:
    assert _lines(tmp_path, default) == []


def test_no_default_of_the_compiler_is_silent() -> None:
    assert complaints(ROOT) == []
