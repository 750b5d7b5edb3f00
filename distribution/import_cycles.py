"""A contract for import-linter that forbids import cycles.

Imports under TYPE_CHECKING and inside functions count as well, and so do imports of a package by the modules inside it,
which the contract ``acyclic_siblings`` does not detect.
"""

from __future__ import annotations

from typing import Any

import networkx
from grimp import ImportGraph
from importlinter import Contract, ContractCheck, output


class NoCyclesContract(Contract):  # type: ignore[misc]
    """``metadata["cycles"]`` has the imports of each cycle, as pairs of importer and imported module with the line."""

    type_name = "no_cycles"

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        """Check all modules of the graph."""
        cycles = cycles_of(graph)
        return ContractCheck(kept=not cycles, metadata={"cycles": cycles})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """One line for each import, with its place."""
        for cycle in check.metadata["cycles"]:
            output.print_error(f"{len({importer for importer, *_ in cycle})} modules import each other:")
            for importer, imported, line in cycle:
                output.print_error(f"- {importer} -> {imported} (l. {line})")
            output.new_line()


def cycles_of(graph: ImportGraph) -> list[list[tuple[str, str, int]]]:
    """The imports within each cycle, in the order of names, with the line of each."""
    imports: Any = networkx.DiGraph()
    for module in graph.modules:
        imports.add_edges_from((module, other) for other in graph.find_modules_directly_imported_by(module))
    found = []
    for component in sorted(map(sorted, networkx.strongly_connected_components(imports))):
        if len(component) > 1:
            found.append(
                [
                    (importer, imported, _line(graph, importer, imported))
                    for importer, imported in sorted(imports.subgraph(component).edges)
                ]
            )
    return found


def _line(graph: ImportGraph, importer: str, imported: str) -> int:
    return min(detail["line_number"] for detail in graph.get_import_details(importer=importer, imported=imported))
