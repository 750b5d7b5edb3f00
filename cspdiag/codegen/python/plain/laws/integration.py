"""The integration of continuous states over one sample."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import (
    PRODUCT,
    SUM,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    code,
    counted_to,
    own,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import For, Function, Statement, Statements, assign, change, return_, unpack
from cspdiag.codegen.shared.laws.equations import changes, held, needed, signals, uses_time
from cspdiag.model.types import Type, is_single
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelClass


@record
class Integration:
    """Writes the derivatives of a class as a method, and the Runge-Kutta (or Euler) step that calls it.

    ``names`` gives the Python name of every signal; ``place`` the source place of an equation or a state.
    """

    class_: SubmodelClass
    names: Names
    place: Callable[[Declared], str]
    imports: Imports

    @property
    def states(self) -> list[str]:
        """The Python names of the continuous states."""
        return [self.names[state.name] for state in self.class_.states if state.continuous]

    @property
    def held(self) -> list[str]:
        """The signals that are passed to the derivatives in addition to the states."""
        return held(self.class_)

    @property
    def timed(self) -> bool:
        """Whether the derivatives depend on the present instant."""
        return uses_time((self.class_.derivatives, self.class_.derivative_equations))

    @property
    def method(self) -> str:
        """The name of the method."""
        return "_derivatives" if len(self.states) > 1 else "_derivative"

    def derivatives(self, printer: Printer, annotations: dict[str, str]) -> Function:
        """The method that evaluates the derivatives from states and held signals."""
        wanted = signals((self.class_.derivatives,))
        parameters = [f"{name}: float" for name in self.states]
        parameters += [f"{self.names[name]}: {annotations[name]}" for name in self.held]
        parameters += ["time: float"] if self.timed else []
        by_state = dict(self.class_.derivatives)
        body: list[Statement] = [
            assign(self.names[equation.name], printer.print(equation.value), self.place(equation))
            for equation in needed(self.class_.derivative_equations, wanted)
            if isinstance(equation, SubmodelEquation)
        ]
        moved = [(state, by_state[name]) for name, state in changes(self.class_).items() if state.continuous]
        if len(moved) == 1:
            ((state, slope),) = moved
            place = self.place(state) if may_fault(slope) else None
            body.append(return_(printer.print(slope), comment=place))
            return Function(self.method, ("self", *parameters), tuple(body), "float")
        results: list[Code] = []
        for state, slope in moved:
            result = printer.print(slope)
            if may_fault(slope):  # It gets a line of its own, with its place.
                name = self.names.fresh(f"{self.names[state.name]}_slope")
                body.append(assign(name, result, self.place(state)))
                result = Name(name)
            results.append(result)
        returns = f"tuple[{', '.join('float' for _ in results)}]"
        return Function(self.method, ("self", *parameters), (*body, return_(*results)), returns)

    def loop(self, steps: Code | None) -> Statements:
        """The statements that integrate the states, which are local variables, over ``steps`` sub-steps of ``h``
        seconds.
        """
        body = self._euler() if self.class_.method == "euler" else self._runge_kutta()
        fractions = () if self.class_.method == "euler" else (assign("half", _part(2)), assign("sixth", _part(6)))
        if steps is None:
            clock = (assign("t", Name("time")),) if self.timed else ()
            return (*fractions, *clock, *body)
        counter = "step" if self.timed else "_"
        clock = (assign("t", begin_of_step()),) if self.timed else ()
        return (*fractions, For(counter, counted_to(steps), (*clock, *body)))

    def _euler(self) -> Statements:
        slopes = self._slopes("slope")
        moved = [self._moved(at, _times("h", slope)) for at, slope in enumerate(slopes)]
        return (self._evaluated(slopes, [Name(state) for state in self.states], Name("t")), *moved)

    def _runge_kutta(self) -> Statements:
        states = self.states
        stages = [self._slopes(f"k{stage}") for stage in (1, 2, 3, 4)]
        statements: list[Statement] = []
        for stage, slopes in enumerate(stages):
            fraction = ("", "half", "half", "h")[stage]
            if fraction:
                before = stages[stage - 1]
                at = [self._rounded(at, _plus(states[at], fraction, slope)) for at, slope in enumerate(before)]
                time = infix("+", SUM, Name("t"), Name(fraction))
                statements.append(self._evaluated(slopes, at, time))
            else:
                statements.append(self._evaluated(slopes, [Name(state) for state in states], Name("t")))
        for position in range(len(states)):
            k1, k2, k3, k4 = (slopes[position] for slopes in stages)
            total = infix("+", SUM, Name(k1), _times(Constant("2.0"), k2))
            total = infix("+", SUM, infix("+", SUM, total, _times(Constant("2.0"), k3)), Name(k4))
            statements.append(self._moved(position, infix("*", PRODUCT, Name("sixth"), total)))
        return tuple(statements)

    def _moved(self, position: int, by: Code) -> Statement:
        """The state at this position, moved."""
        state = self.states[position]
        if not is_single(self._types[position]):
            return change(state, "+=", by)
        return assign(state, self._rounded(position, infix("+", SUM, Name(state), by)))

    def _rounded(self, position: int, value: Code) -> Code:
        return rounded(value, self._types[position], self.imports)

    @property
    def _types(self) -> list[Type]:
        return [state.type for state in self.class_.states if state.continuous]

    def _slopes(self, prefix: str) -> list[str]:
        """A local variable for the slope of each state; signals may be called ``k1``, too."""
        if len(self.states) == 1:
            return [self.names.fresh(prefix)]
        return [self.names.fresh(f"{prefix}_{state}") for state in self.states]

    def _evaluated(self, slopes: Sequence[str], at: Sequence[Code], time: Code) -> Statement:
        arguments = [*at, *(Name(self.names[name]) for name in self.held), *([time] if self.timed else [])]
        return unpack([Name(slope) for slope in slopes], call(own(self.method), *arguments))


def rounded(value: Code, type_: Type, imports: Imports) -> Code:
    """What a state of this type becomes."""
    return call(imports.runtime("float32"), value) if is_single(type_) else value


def begin_of_step() -> Code:
    """The instant at which a sub-step begins."""
    return infix("+", SUM, Name("time"), _times("step", "h"))


def _part(count: int) -> Code:
    return infix("/", PRODUCT, Name("h"), WholeNumber(count))


def _times(factor: Code | str, name: str) -> Code:
    return infix("*", PRODUCT, code(factor), Name(name))


def _plus(state: str, fraction: str, slope: str) -> Code:
    return infix("+", SUM, Name(state), _times(fraction, slope))
