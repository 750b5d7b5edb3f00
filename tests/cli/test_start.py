"""What a command loads: ``check`` has little time, so it loads little."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
HEAVY = {"numpy", "networkx", "jinja2", "control", "matplotlib", "scipy", "hypothesis"}
UNNEEDED_BY_CHECK = {
    "dataclasses",
    "decimal",
    "inspect",
    "json",
    "pathlib",
    "shutil",
    "tempfile",
    "subprocess",
    "asyncio",
    "importlib.metadata",
    "cspdiag.runtime",
    "cspdiag.codegen",
}


def modules_after(statements: str) -> set[str]:
    program = f"import sys\n{statements}\nprint(*sys.modules)"
    result = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(result.stdout.split())


def test_importing_the_package_loads_nothing_else() -> None:
    loaded = modules_after("import cspdiag")
    assert {name for name in loaded if name.startswith("cspdiag")} == {"cspdiag"}
    assert not loaded & (HEAVY | {"lark"})


def test_check_loads_no_heavy_package() -> None:
    loaded = modules_after("from cspdiag.cli.main import main\nassert main(['check', 'models/jiwy/jiwy.csp']) == 0")
    assert "cspdiag.network.check" in loaded
    assert not loaded & HEAVY
    assert not loaded & UNNEEDED_BY_CHECK


def test_checking_from_python_loads_no_heavy_package() -> None:
    assert not modules_after("import cspdiag\nassert cspdiag.check('models/jiwy/jiwy.csp') == []") & HEAVY


def test_a_proof_loads_neither_the_runtime_nor_what_draws() -> None:
    loaded = modules_after(
        "from cspdiag.cli.main import main\n"
        "assert main(['verify', '--no-cache', '--process', 'Table', 'models/dining/dining.csp']) == 0"
    )
    assert "cspdiag.proofs.verdict" in loaded
    assert not loaded & (HEAVY | {"cspdiag.runtime", "cspdiag.draw", "cspdiag.codegen", "cspdiag.simulate"})


def test_asking_a_server_loads_almost_nothing() -> None:
    ask = "from cspdiag.__main__ import main\nfrom cspdiag.cli.server import client\nclient.answered(['check'])"
    loaded = modules_after(ask) - modules_after("")
    needed = ("__main__", "cli", "cli.server", "cli.server.client", "cli.server.messages", "cli.server.place")
    assert loaded - {"__future__", "_socket", "gc"} == {"cspdiag", *(f"cspdiag.{name}" for name in needed)}
