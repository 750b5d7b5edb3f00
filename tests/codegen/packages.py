"""Networks and generated packages of the models and of the programs in this folder."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import CoreNetwork
from tests.codegen import networks

ROOT = Path(__file__).parents[2]
PROGRAMS = Path(__file__).parent / "programs"

MODELS = {
    path.stem: path
    for path in sorted((ROOT / "models").glob("*/*.csp"))
    if path.stem == path.parent.name or path.stem == "deadlock"
}
OWN = {path.stem: path for path in sorted(PROGRAMS.glob("*.csp"))}
NAMES = [*MODELS, *OWN, *networks.ALL]


def read(path: str) -> SourceFile:
    """A file, named relative to the checkout."""
    return SourceFile(name=path, text=(ROOT / path).read_text(encoding="utf-8"))


@cache
def network(name: str) -> CoreNetwork:
    """The network of a model, of a program, or of a handmade one."""
    if name in networks.ALL:
        return networks.ALL[name]()
    path = str((MODELS | OWN)[name].relative_to(ROOT))
    built = pipeline.build(read(path), read)
    assert built.network is not None, [f"{d.span}: {d.message}" for d in built.checked.report.diagnostics]
    return built.network


@cache
def package(name: str, level: int = 0) -> Mapping[str, str]:
    """The generated files."""
    return pipeline.generate(network(name), read, level=level)


def written_by_generator(name: str, level: int = 0) -> dict[str, str]:
    """The generated files without the copied runtime."""
    return {path: text for path, text in package(name, level).items() if path.split("/")[1:2] != ["runtime"]}
