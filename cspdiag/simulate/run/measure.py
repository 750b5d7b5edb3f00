"""Times the control laws of a running Python program."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cspdiag.runtime import Network as RunningNetwork
    from cspdiag.runtime import Submodel
    from cspdiag.simulate.record.recorder import Recorder


def measure(running: RunningNetwork, recorder: Recorder) -> None:
    """Let every law report its execution times to ``recorder``, from now on.

    Laws that ``-O1`` has inlined into their processes are not objects of their own, and are not measured.
    """
    for law in _laws(running.process):
        law.calculate = _timed(law.name, law.calculate, recorder)  # type: ignore[attr-defined]


def _timed(path: str, calculate: Callable[..., Any], recorder: Recorder) -> Callable[..., Any]:
    def timed(*inputs: Any) -> Any:
        began = time.thread_time_ns()
        outputs = calculate(*inputs)
        recorder.execution_time(path, time.thread_time_ns() - began)
        return outputs

    return timed


def _laws(process: object) -> Iterator[Submodel]:
    from cspdiag.runtime import Submodel
    from cspdiag.simulate.run.probes import parts_of

    return (part for part in parts_of(process) if isinstance(part, Submodel) and hasattr(part, "calculate"))
