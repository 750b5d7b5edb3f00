"""Which parts of a program lie on a way from a law through the plant back to it, and whether all of them are followed.

Every influence counts, also one that cannot be followed: conditions, laws that stop or saturate, processes written by
hand. So a loop whose margins might be wrong is found here, and refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from cspdiag.analyses.margins.composition.regular import Turn, Turns
from cspdiag.analyses.margins.composition.turns import Composition, Statement, are_active_together
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.base import Span
from cspdiag.base.graphs import reached
from cspdiag.base.record import record
from cspdiag.model.types import RealType
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    Conversion,
    Expression,
    FunctionCall,
    UnaryOperation,
    Value,
    VariableValue,
)
from cspdiag.network.ir.network import CoreNetwork, Environment, SubmodelClass

if TYPE_CHECKING:
    from cspdiag.network.ir.network import Net

ADVICE = "let the loop take its samples, compute and write once in each period, without conditions or waits"


@record
class Feedback:
    """What lies on the ways from a law through the plant back to it: nets, variables and laws, by path, and the turns
    that carry them. Empty without such a way.
    """

    members: frozenset[str]
    turns: tuple[Turn, ...] = ()


class FeedbackSearch:
    """Finds what lies on the ways from laws through the plant back to them."""

    def __init__(self, network: CoreNetwork, environment: Environment) -> None:
        assert environment.system is not None
        self.network = network
        self.composition = Composition(network)
        self.turns = Turns(network, self.composition)
        self.runs = self.composition.laws_run()
        self.nets: dict[str, Net] = self.turns.nets
        self.parameters = {instance.path: dict(instance.arguments) for instance in network.instances}
        self._plant = _responses(environment.system, [net for net in network.nets if net.external is not None])
        self._found: dict[str, Feedback] = {}

    def period(self, law: str) -> int:
        """The period of the loop that runs a law, in nanoseconds; 0 if it is not known."""
        turn = self._turn_of(law)
        return 0 if turn is None else turn.period

    def _turn_of(self, law: str) -> Turn | None:
        turns = [self.turns.found[run.turn] for run in self.runs.get(law, ()) if run.turn is not None]
        return turns[0] if len(turns) == 1 else None

    def _run(self, law: str) -> Statement:
        runs = self.runs[law]
        return next((run for run in runs if run.turn is not None), runs[0])

    def of(self, law: str) -> Feedback:
        """The feedback of a law. Raises NotLinearError if a part of it cannot be followed."""
        if law not in self._found:
            self._found[law] = self._feedback(law)
        return self._found[law]

    def _feedback(self, law: str) -> Feedback:
        active = self._active(law)
        edges = self.influences(law)
        backward: dict[str, set[str]] = {}
        for node, targets in edges.items():
            for target in targets:
                backward.setdefault(target, set()).add(node)
        members = _reached(law, edges) & _reached(law, backward)
        if not any(path in members and net.external == "out" for path, net in self.nets.items()):
            return Feedback(frozenset())
        self._check_run(law, law)
        self._check_in_time()
        for path in members:
            self._check_place(path)
        turns: dict[int, Turn] = {}
        for part in active:
            if part.law in members or part.target in members:
                turn = self._followed(part, law, members)
                turns.setdefault(id(turn), turn)
        found = tuple(turns.values())
        self._check_takes(found, members)
        return Feedback(members, found)

    def _active(self, law: str) -> list[Statement]:
        """The statements that belong to the same mode as a law."""
        position = self._run(law).position
        return [part for part in self.composition.statements if are_active_together(part.position, position)]

    def influences(self, law: str) -> dict[str, set[str]]:
        """What each net, variable, law or process has an effect on while a law is active; laws that are slower are left
        open.
        """
        active, period = self._active(law), self.period(law)
        edges: dict[str, set[str]] = {net: set(targets) for net, targets in self._plant.items()}

        def add(sources: Iterable[str], target: str) -> None:
            for source in sources:
                edges.setdefault(source, set()).add(target)

        for part in active:
            if part.target is not None:
                add((*part.sources, *part.deciding), part.target)
            elif part.law is not None and not (period and self.period(part.law) > period):
                self._add_process(part.law, add)
                add(part.deciding, part.law)
        for path in self.composition.written_by_hand:
            self._add_process(path, add)
        return edges

    def _add_process(self, path: str, add: Callable[[Iterable[str], str], None]) -> None:
        add(self.turns.read_by.get(path, ()), path)
        for written in self.turns.written_by.get(path, ()):
            add((path,), written)

    def _check_run(self, law: str, cut: str) -> None:
        """Refuse a law that does not run exactly once in each period of its loop."""
        runs = self.runs[law]
        chosen = self._run(law)
        name = f"`{law.partition('.')[2]}`"
        for run in runs:
            if run is not chosen and (run.turn is not None or are_active_together(run.position, chosen.position)):
                raise NotLinearError(f"{name} is run in several places; run it in one; {ADVICE}", run.span)
        turn = self._turn_of(law)
        if chosen.reason or turn is None:
            reason = chosen.reason or "it is not in a loop"
            raise NotLinearError(f"{name} does not run once in each period: {reason}; {ADVICE}", chosen.span)
        if not turn.period or chosen not in turn.main:
            reason = turn.reason or "it runs in a branch without samples"
            raise NotLinearError(f"{name} does not run once in each period: {reason}; {ADVICE}", turn.span)
        own = self.period(cut)
        if own % turn.period:
            raise NotLinearError(
                f"its period is not a multiple of that of {name}, which is part of the loop", chosen.span
            )
        sample = self.parameters[law].get("sample")
        if isinstance(sample, float) and abs(sample * 1e9 - turn.period) > 0.5:
            raise NotLinearError(
                f"{name} computes with a sample period of {sample:g} s, but its loop has another one", chosen.span
            )

    def _check_in_time(self) -> None:
        """Refuse if samples may be missed, or partners may wait for each other, even if computing takes no time."""
        if self._late is not None:
            reason = f"`{self._late.subject}`: {self._late.reason}"
            raise NotLinearError(
                f"it may miss samples: {reason}; `cspdiag verify --timing` shows this too", self._late.span
            )

    @cached_property
    def _late(self) -> Refusal | None:
        """Why samples may be missed even if computing takes no time."""
        times = dict.fromkeys(self.runs, 0) | dict.fromkeys(self.composition.written_by_hand, 0)
        return next(iter(timing_report(self.network, times).refusals), None)

    def _check_place(self, path: str) -> None:
        if path in self.composition.written_by_hand:
            raise NotLinearError(
                f"`{path.partition('.')[2]}`, which is written in another language, is part of the loop",
                self.composition.written_by_hand[path],
            )
        net = self.nets.get(path)
        if net is None:
            return
        name = f"`{path.partition('.')[2]}`"
        if net.external == "in" and net.sampling is None:
            raise NotLinearError(f"{name} is an event and part of the loop; let it be sampled (`@ T`)", net.span)
        if net.kind not in ("var", "sync") and net.external != "in":
            raise NotLinearError(
                f"{name} is a channel of kind `{net.kind}` and part of the loop; margins follow variables and plain "
                "rendezvous",
                net.span,
            )

    def _followed(self, part: Statement, law: str, members: frozenset[str]) -> Turn:
        """The turn of a statement. Raises NotLinearError if the statement is not followed."""
        if part.law is not None:
            self._check_run(part.law, law)
            turn = self._turn_of(part.law)
            assert turn is not None
            return turn
        assert part.target is not None
        place = part.target.partition(".")[2]
        if part.reason or part.turn is None:
            raise NotLinearError(
                f"`{place}`, which is part of the loop, gets a value here, and {part.reason}; {ADVICE}", part.span
            )
        turn = self.turns.found[part.turn]
        if not turn.period:
            raise NotLinearError(
                f"`{place}`, which is part of the loop, gets a value in a loop whose periods differ: {turn.reason}; "
                f"{ADVICE}",
                turn.span,
            )
        if self.period(law) % turn.period:
            raise NotLinearError(
                f"`{place}`, which is part of the loop, gets a value in a slower loop without a law; {ADVICE}",
                part.span,
            )
        if part.value is not None:
            coefficients(part, members, self.composition, self.parameters[part.process])
        return turn

    def _check_takes(self, turns: tuple[Turn, ...], members: frozenset[str]) -> None:
        """Refuse values that a loop takes besides its samples, if it is not known whether before or after them."""
        for turn in turns:
            for part in turn.leading:
                written = self.turns.written_by.get(part.law, ()) if part.law is not None else [part.target or ""]
                if any(net in members and self._is_rendezvous(net) for net in (*self.turns.reads(part), *written)):
                    raise NotLinearError(
                        "this communication comes before the loop has taken its samples, so it may belong to the "
                        "period before; let the loop take its samples first",
                        part.span,
                    )
            for branch in (*turn.before, *turn.after):
                if not any(part.target in members for part in branch):
                    continue
                span = branch[0].span
                taken = self.turns.reads(branch[0])
                writers = [
                    other for other in turns for part in other.main
                    for net in taken if part.target == net or self.turns.is_written_by(part, net)
                ]  # fmt: skip
                others = [self.nets.get(net) for net in taken]
                if not turn.loop.prioritized:
                    raise NotLinearError(
                        "which branch of this alternative comes first is not followed; write `[]>`", turn.loop.span
                    )
                if any(net is None or net.external is not None for net in others):
                    raise NotLinearError(f"a branch that takes a sample or an event is not followed; {ADVICE}", span)
                if any(self.turns.reads(part) for part in branch[1:]) or any(part.law for part in branch):
                    raise NotLinearError(f"a branch that communicates again is not followed; {ADVICE}", span)
                if not any(net in members for net in taken):
                    raise NotLinearError(
                        "a variable that is part of the loop gets another value here; margins would be those of "
                        "neither",
                        span,
                    )
                for writer in writers:
                    self._check_order(turn, writer, span)
                if len(writers) != 1:
                    raise NotLinearError(f"what writes the value that is taken here is not followed; {ADVICE}", span)

    def _check_order(self, turn: Turn, writer: Turn, span: Span) -> None:
        known = len(turn.inputs) == len(writer.inputs) == 1 or rank(turn) != rank(writer)
        waits = [net for part in writer.main for net in self.turns.reads(part) if self._is_rendezvous(net)]
        own = [net for part in turn.main for net in self.turns.reads(part) if self._is_rendezvous(net)]
        if not known or waits or own or writer.period % turn.period or not writer.inputs or not turn.inputs:
            raise NotLinearError(
                "whether this value is taken before or after the samples of its instant is not known; give the two "
                "loops different priorities (`||>`), and let each wait only for its samples",
                span,
            )

    def _is_rendezvous(self, path: str) -> bool:
        net = self.nets.get(path)
        return net is not None and net.external is None and net.kind != "var"


def _reached(start: str, edges: Mapping[str, Iterable[str]]) -> frozenset[str]:
    def after(node: str) -> Iterable[str]:
        return edges.get(node, ())

    return frozenset(reached([start], after))


def rank(turn: Turn) -> tuple[int, ...]:
    """The priority of a loop, without the zeros at its end, which count as if they were not there."""
    priority = turn.loop.priority
    while priority and priority[-1] == 0:
        priority = priority[:-1]
    return priority


def coefficients(
    part: Statement, members: frozenset[str], composition: Composition, parameters: Mapping[str, Value]
) -> dict[str, float]:
    """The factors with which the members of a loop enter what is assigned or written. Raises NotLinearError."""
    from cspdiag.network.elaborate.constant_value import constant_value

    def is_member(expression: Expression) -> bool:
        return any(path in members for path in composition.variables(part.process, expression))

    def constant(expression: Expression) -> float:
        value = constant_value(expression, lambda name: parameters.get(name.name))
        if not isinstance(value, float):
            raise NotLinearError("this factor of a value of the loop is not a constant", expression.span or part.span)
        return value

    def found(expression: Expression) -> dict[str, float]:
        if not is_member(expression):
            return {}
        match expression:
            case VariableValue():
                return {composition.variables(part.process, expression)[0]: 1.0}
            case UnaryOperation(operator="-"):
                return _scaled(found(expression.operand), -1.0)
            case Conversion() if isinstance(expression.operand.type, RealType) and isinstance(
                expression.type, RealType
            ):
                return found(expression.operand)
            case FunctionCall(function="finite"):
                return found(expression.arguments[0])
            case BinaryOperation(operator="+" | "-"):
                sign = 1.0 if expression.operator == "+" else -1.0
                left, right = found(expression.left), _scaled(found(expression.right), sign)
                return {name: left.get(name, 0.0) + right.get(name, 0.0) for name in {**left, **right}}
            case BinaryOperation(operator="*") if not is_member(expression.left):
                return _scaled(found(expression.right), constant(expression.left))
            case BinaryOperation(operator="*") if not is_member(expression.right):
                return _scaled(found(expression.left), constant(expression.right))
            case BinaryOperation(operator="/") if not is_member(expression.right):
                divisor = constant(expression.right)
                if not divisor:
                    raise NotLinearError("a value of the loop is divided by zero", expression.span or part.span)
                return _scaled(found(expression.left), 1 / divisor)
            case _:
                raise NotLinearError(
                    "a composition computes this from values of the loop, and not by adding them and multiplying them "
                    "with constants; compute it in a submodel",
                    expression.span or part.span,
                )

    assert part.value is not None
    return found(part.value)


def _scaled(factors: dict[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in factors.items()}


def _responses(plant: SubmodelClass, nets: Iterable[Net]) -> dict[str, set[str]]:
    """The inputs of the program that may depend on each of its outputs, now or later, as paths of nets."""
    after: dict[str, set[str]] = {}
    for equation in (*plant.equations, *plant.derivative_equations):
        if isinstance(equation, ExternalCall):
            for _, given in equation.inputs:
                for name in signals_read(given):
                    after.setdefault(name, set()).update(local for _, local, _ in equation.outputs)
        else:
            for name in signals_read(equation.value):
                after.setdefault(name, set()).add(equation.name)
    for target, value in (*plant.next_values, *plant.derivatives):
        for name in signals_read(value):
            after.setdefault(name, set()).add(target)
    paths = {net.path.partition(".")[2]: net for net in nets}
    found: dict[str, set[str]] = {}
    for port, net in paths.items():
        if net.external == "out":
            moved = reached([port], lambda name: after.get(name, ()))
            found[net.path] = {paths[name].path for name in moved if name in paths and paths[name].external == "in"}
    return found
