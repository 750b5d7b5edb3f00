"""The share of the processor that the control laws need, from their worst-case execution times.

This is a lower bound: laws without ``wcet`` or without a period count as zero, and of parts in sequence or branches of
an alternative only the most demanding one counts. Laws that follow one another on the same sample add up.
"""

from __future__ import annotations

from cspdiag.analyses.analysis import Analysis
from cspdiag.analyses.diagnostics.load import Overload
from cspdiag.base import Report, Span
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.network.analyse import Analysis as Checked
from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import CoreNetwork, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import actions_inside, parts
from cspdiag.network.shapes import UNKNOWN_SAMPLING, Shape
from cspdiag.syntax import ast


def may_be_overloaded(program: Program, checked: Checked) -> bool:
    """Whether the laws may need more than the entire processor: if all those that the compositions run, each as often
    as it occurs there, were run in the shortest of all periods.
    """
    times: dict[ast.Definition, int] = {}
    for definition in program.definitions.values():
        if isinstance(definition, ast.SubmodelDefinition) and definition.wcet is not None:
            time = evaluate(program, definition.wcet, {}, Report())
            if not isinstance(time, int):
                return True
            times[definition] = time
    shapes = checked.inside_out()
    sampled = [port.sampling for shape in shapes for port in shape.ports.values() if port.sampling is not None]
    if not times or not sampled:
        return False
    if UNKNOWN_SAMPLING in sampled:
        return True
    shortest = min(sampling.period for sampling in sampled)
    needed: dict[Shape, int] = {}
    for shape in shapes:
        inner = [shape.instances[part.instance].shape for part in parts(shape.body) if isinstance(part, ir.RunInstance)]
        needed[shape] = sum(needed.get(one, times.get(one.definition, 0)) for one in inner)
    return any(time > shortest for time in needed.values())


def check_load(network: CoreNetwork, report: Report) -> None:
    """Warn if the laws need more than the whole processor."""
    loads = _Loads(network)
    share = loads.of_instance(network.top)
    if share > 1:
        laws = sorted(loads.laws, key=lambda law: (-law[1], law[0]))
        top = loads.classes[network.top]
        report.add(Overload(span=top.span, process=network.top, percent=round(100 * share), laws=tuple(laws)))


class _Loads:
    def __init__(self, network: CoreNetwork) -> None:
        self.classes = {entry.name: entry for entry in network.classes}
        self.class_of = {instance.path: self.classes[instance.class_name] for instance in network.instances}
        self.periods: dict[str, int] = {}
        """The shortest period of the nets of a leaf process, by its path."""
        self.samplers: set[str] = set()
        """Leaf processes that read a sampled net, so each run of them begins a new period."""
        for net in network.nets:
            if net.sampling is None:
                continue
            for path, _ in (*net.writers, *net.readers):
                self.periods[path] = min(net.sampling.period, self.periods.get(path, net.sampling.period))
            self.samplers.update(path for path, _ in net.readers)
        self.laws: list[tuple[str, int, Span]] = []

    def of_instance(self, path: str) -> float:
        """The share of the processor that an instance needs, with all instances inside it."""
        entry = self.class_of[path]
        if isinstance(entry, ProcessClass):
            return self._action(path, entry.body) if entry.body is not None else 0.0
        return self._law(path, entry, self.periods.get(path))

    def _law(self, path: str, law: SubmodelClass, period: int | None) -> float:
        if law.wcet is None or period is None:
            return 0.0
        share = law.wcet / period
        self.laws.append((path, round(100 * share), law.span))
        return share

    def _action(self, path: str, action: ir.CoreAction) -> float:
        match action:
            case ir.RunInstance():
                return self.of_instance(f"{path}.{action.instance}")
            case ir.SequentialSteps():
                return self._sequence(path, action.steps)
            case ir.ParallelSteps():
                return sum(self._action(path, step) for step in action.steps)
            case _:  # Of the parts of any other action one runs at a time.
                return max((self._action(path, inner) for inner in actions_inside(action)), default=0.0)

    def _sequence(self, path: str, steps: tuple[ir.CoreAction, ...]) -> float:
        """The largest share of a sequence: a law that reads a sample begins a period, and later laws that read none run
        in the same period. What comes after a step that never ends does not run.
        """
        largest = present = 0.0
        period: int | None = None
        for step in steps:
            inner = f"{path}.{step.instance}" if isinstance(step, ir.RunInstance) else ""
            law = self.class_of.get(inner)
            if isinstance(law, SubmodelClass) and inner not in self.samplers:
                present += self._law(inner, law, self.periods.get(inner, period))
            else:
                present = self._action(path, step)
                period = self.periods.get(inner)
            largest = max(largest, present)
            if not may_end(step):
                break
        return largest


LOAD = Analysis(concerns=may_be_overloaded, run=check_load)
