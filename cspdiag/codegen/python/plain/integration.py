"""The integration of continuous states over one sample."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import PRODUCT, SUM, Argument, Atom, Call, Code, infix, tuple_of
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.statements import Block, Line, Statement, Unpack, assign, lines, signature
from cspdiag.codegen.shared.equations import held, needed, signals, uses_time
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.network import SubmodelClass


@record
class Integration:
    """Writes the derivatives of a class as a method and the Runge-Kutta (or Euler) step that calls it.

    ``names`` gives the Python name of every signal; ``place`` says where something stands in the text.
    """

    class_: SubmodelClass
    names: Names
    place: Callable[[SubmodelEquation], str]

    @property
    def states(self) -> list[str]:
        """The Python names of the continuous states."""
        return [self.names[state.name] for state in self.class_.states if state.continuous]

    @property
    def held(self) -> list[str]:
        """The signals that the derivatives get besides the states."""
        return held(self.class_)

    @property
    def timed(self) -> bool:
        """Whether the derivatives depend on the present instant."""
        return uses_time((self.class_.derivatives, self.class_.derivative_equations))

    @property
    def method(self) -> str:
        """The name of the method."""
        return "_derivatives" if len(self.states) > 1 else "_derivative"

    def derivatives(self, printer: Printer, annotations: dict[str, str]) -> list[str]:
        """The method that evaluates the derivatives from states and held signals."""
        wanted = signals((self.class_.derivatives,))
        parameters = [f"{name}: float" for name in self.states]
        parameters += [f"{self.names[name]}: {annotations[name]}" for name in self.held]
        parameters += ["time: float"] if self.timed else []
        by_state = dict(self.class_.derivatives)
        results = [printer.print(by_state[state.name]) for state in self.class_.states if state.continuous]
        body: list[Statement] = [
            assign(self.names[equation.name], printer.print(equation.value), self.place(equation))
            for equation in needed(self.class_.derivative_equations, wanted)
            if isinstance(equation, SubmodelEquation)
        ]
        if len(results) == 1:
            returns, result = "float", Line("return ", results[0])
        else:
            returns = f"tuple[{', '.join('float' for _ in results)}]"
            flat = ", ".join(code.flat for code in results)
            fits = len(flat) + 15 <= 100
            result = Line("return ", Atom(flat) if fits else tuple_of(results))
        head = signature(f"def {self.method}", ["self", *parameters], f" -> {returns}:", "    ")
        return [*head, *lines([*body, result], "        ")]

    def loop(self, steps: Code | None) -> tuple[Statement, ...]:
        """The statements that move the states, which are local variables, over ``steps`` sub-steps of ``h`` seconds."""
        body = self._euler() if self.class_.method == "euler" else self._runge_kutta()
        fractions = () if self.class_.method == "euler" else (assign("half", _part(2)), assign("sixth", _part(6)))
        if steps is None:
            clock = (assign("t", Atom("time")),) if self.timed else ()
            return (*fractions, *clock, *body)
        counter = "step" if self.timed else "_"
        clock = (assign("t", Atom("time + step * h")),) if self.timed else ()
        return (*fractions, Block(Line(f"for {counter} in ", Call("range", (Argument(steps),)), ":"), (*clock, *body)))

    def _euler(self) -> tuple[Statement, ...]:
        slopes = self._slopes("slope")
        moved = [Line(f"{state} += ", _times("h", slope)) for state, slope in zip(self.states, slopes, strict=True)]
        statements: list[Statement] = [self._evaluated(slopes, [Atom(state) for state in self.states], Atom("t"))]
        return (*statements, *moved)

    def _runge_kutta(self) -> tuple[Statement, ...]:
        states = self.states
        stages = [self._slopes(f"k{stage}") for stage in (1, 2, 3, 4)]
        statements: list[Statement] = []
        for stage, slopes in enumerate(stages):
            fraction = ("", "half", "half", "h")[stage]
            if fraction:
                before = stages[stage - 1]
                at = [_plus(state, fraction, slope) for state, slope in zip(states, before, strict=True)]
                time = infix("+", SUM, Atom("t"), Atom(fraction))
                statements.append(self._evaluated(slopes, at, time))
            else:
                statements.append(self._evaluated(slopes, [Atom(state) for state in states], Atom("t")))
        for position, state in enumerate(states):
            k1, k2, k3, k4 = (slopes[position] for slopes in stages)
            total = infix("+", SUM, Atom(k1), _times("2", k2))
            total = infix("+", SUM, infix("+", SUM, total, _times("2", k3)), Atom(k4))
            statements.append(Line(f"{state} += ", infix("*", PRODUCT, Atom("sixth"), total)))
        return tuple(statements)

    def _slopes(self, prefix: str) -> list[str]:
        if len(self.states) == 1:
            return [prefix]
        return [f"{prefix}_{state}" for state in self.states]

    def _evaluated(self, slopes: Sequence[str], at: Sequence[Code], time: Code) -> Statement:
        arguments = [*at, *(Atom(self.names[name]) for name in self.held), *([time] if self.timed else [])]
        evaluated = Call(f"self.{self.method}", tuple(Argument(value) for value in arguments))
        if len(slopes) == 1:
            return assign(slopes[0], evaluated)
        return Unpack(tuple(slopes), evaluated)


def _part(count: int) -> Code:
    return infix("/", PRODUCT, Atom("h"), Atom(str(count)))


def _times(factor: str, name: str) -> Code:
    return infix("*", PRODUCT, Atom(factor), Atom(name))


def _plus(state: str, fraction: str, slope: str) -> Code:
    return infix("+", SUM, Atom(state), _times(fraction, slope))
