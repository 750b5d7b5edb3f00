"""Loops as systems of python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.analyses.margins.open_loop import OpenLoop, minimal

if TYPE_CHECKING:
    import control  # type: ignore[import-untyped]


def state_space(loop: OpenLoop) -> control.StateSpace:
    """The loop of negative feedback, over the states that take part in it; see ``AnalysedLoop.to_control``."""
    import control

    a, b, c, d = minimal(loop)
    return control.ss(
        a,
        b,
        -c,
        -d,
        loop.period,
        name=loop.cut.name.rpartition(".")[0].replace(".", "_"),
        inputs=["e"],
        outputs=[loop.cut.name.rpartition(".")[2]],
        states=[_name(kind, *leaf) for kind, leaf in loop.kept],
    )


def _name(kind: str, port: str, indexes: tuple[object, ...]) -> str:
    """The name of a state in python-control, which allows no dots."""
    return f"{kind}:{port}{''.join(f'[{k}]' for k in indexes)}".replace(".", "_")
