"""The integration of continuous states over one sample, in the order of operations of every target."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import Check, EquationWriter, LocalVariable, check_finite_together
from cspdiag.codegen.c.text.code import (
    CSP,
    PRODUCT,
    SUM,
    Assignment,
    Atom,
    Code,
    call,
    cast,
    code,
    infix,
    own,
)
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    For,
    Function,
    Plain,
    Statement,
    define,
    return_value,
    store,
    with_kernel,
)
from cspdiag.codegen.c.text.types import duration
from cspdiag.codegen.shared.laws.equations import Equation, needed, signals, uses_time, values
from cspdiag.model.types import Type, is_single
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import Expression, ParameterValue, SignalValue, TunableValue, VariableValue
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelState
from cspdiag.network.ir.walk import PartsByType


@record
class Integration:
    """Writes the slopes of continuous states as a function, and the Runge-Kutta (or Euler) step that calls it.

    ``name`` is the name of the function, ``owner`` the struct that contains constants and parameters. ``local`` gives
    the C name of every signal that changes or is held, ``types`` their types. ``states`` are the continuous states,
    ``held`` the other signals that the slopes read, which do not change during the step. ``changes`` has the place of
    each derivative.
    """

    name: str
    owner: str
    local: Callable[[str], str]
    types: dict[str, Type]
    states: tuple[str, ...]
    held: tuple[str, ...]
    equations: tuple[SubmodelEquation, ...]
    derivatives: tuple[tuple[str, Expression], ...]
    changes: Mapping[str, SubmodelState]
    method: str

    @property
    def depends_on_time(self) -> bool:
        """Whether the slopes depend on the present instant."""
        return uses_time((self.derivatives, self.equations))

    @property
    def can_fault(self) -> bool:
        """Whether the evaluation of the slopes can fault."""
        values = [value for _, value in self.derivatives]
        values += [equation.value for equation in self.equations]
        return any(map(may_fault, values)) or bool(PartsByType(values).of(VariableValue))

    @property
    def has_several_states(self) -> bool:
        """Whether there is more than one state, so that slopes are a struct."""
        return len(self.states) > 1

    @cached_property
    def _read(self) -> frozenset[str]:
        """The signals that the slopes depend on."""
        equations = needed(self.equations, signals((self.derivatives,)))
        return frozenset(signals((self.derivatives, tuple(part for item in equations for part in values(item)))))

    @property
    def _states_read(self) -> list[str]:
        return [state for state in self.states if state in self._read]

    @property
    def _held_read(self) -> list[str]:
        return [name for name in self.held if name in self._read]

    def function(self, printer: Printer, writer: EquationWriter) -> list[Statement]:
        """The function that evaluates the slopes. It notes a fault with its place; the caller checks for one."""
        result = f"struct {self.name}" if self.has_several_states else "double"
        statements: list[Statement] = []
        if self.has_several_states:
            members = tuple(define("double", self.local(state)) for state in self.states)
            statements += [Block(members, f"struct {self.name}", "};"), Blank()]
        parameters = [KERNEL] if self.can_fault else []
        parameters += [f"const struct {self.owner} *self"] if self._needs_owner else []
        given = [*self._states_read, *self._held_read]
        parameters += [f"{printer.types.type_name(self.types[name])} {self.local(name)}" for name in given]
        parameters += ["double time"] if self.depends_on_time else []
        equations: list[Equation] = list(needed(self.equations, signals((self.derivatives,))))
        signal_types = {equation.name: equation.type for equation in self.equations}
        body = writer.equations(
            equations,
            lambda name: LocalVariable(f"const {printer.types.type_name(signal_types[name])}", self.local(name)),
        )
        by_state = dict(self.derivatives)

        def place(state: str) -> str:
            return writer.place(self.changes[state])

        if not self.has_several_states:
            (state,) = self.states
            body += writer.assign(LocalVariable("const double", "slope"), by_state[state], None, place(state))
            body.append(return_value("slope"))
        else:
            body.append(define(f"struct {self.name}", "slopes"))
            for state in self.states:
                body += writer.assign(code("slopes").field(self.local(state)), by_state[state], None, place(state))
            body.append(return_value("slopes"))
        return [
            *statements,
            Function(
                f"static inline {result} {self.name}",
                tuple(parameters),
                with_kernel(body) if self.can_fault else tuple(body),
            ),
        ]

    @cached_property
    def _needs_owner(self) -> bool:
        """Whether the slopes depend on members of the struct, not only on the arguments of the function."""
        if not self.owner:
            return False
        given = {*self.states, *self.held, *(equation.name for equation in self.equations)}
        inside = PartsByType((self.derivatives, self.equations))
        read = {part.name for part in inside.of(SignalValue)}
        read |= {part.name for part in inside.of(ParameterValue)} | {part.name for part in inside.of(TunableValue)}
        return bool(inside.of(VariableValue)) or not read <= given

    def steps(self, outer: Callable[[str], Code], count: Code | None) -> list[Statement]:
        """The statements that integrate the states, which are local variables, over ``count`` steps of ``h`` seconds.

        ``outer`` gives the lvalues of the held signals in the function that contains the statements.
        """
        shared: list[Code] = [CSP] if self.can_fault else []
        shared += [Atom("self")] if self._needs_owner else []
        held = [outer(name) for name in self._held_read]
        statements: list[Statement] = []
        if self.method != "euler":
            if self._states_read or self.depends_on_time:
                statements.append(define("const double", "half", _fraction("2.0")))
            statements.append(define("const double", "sixth", _fraction("6.0")))
        body: list[Statement] = []
        if self.depends_on_time:
            elapsed = infix("*", PRODUCT, cast("double", Atom("step")), Atom("h"))
            time = infix("+", SUM, Atom("time"), elapsed) if count is not None else Atom("time")
            body.append(define("const double", "t", time))
        body += (self._euler if self.method == "euler" else self._runge_kutta)(shared, held)
        if count is None:
            return [*statements, *body]
        return [*statements, For(Atom("step"), count, tuple(body), type_name="int64_t")]

    def check(self, places: Sequence[str], check: Check) -> list[Statement]:
        """The check after the steps that all states are finite; ``places`` are those of their faults."""
        values = [code(self.local(state)) for state in self.states]
        return check_finite_together(list(zip(values, places, strict=True)), check, may_have_faulted=self.can_fault)

    def _slope(self, stage: str, state: str) -> Code:
        return code(stage).field(self.local(state)) if self.has_several_states else code(stage)

    def _evaluated(self, stage: str, at: Sequence[Code], time: Code, shared: list[Code], held: list[Code]) -> Plain:
        arguments = [*shared, *at, *held, *([time] if self.depends_on_time else [])]
        type_name = f"const struct {self.name}" if self.has_several_states else "const double"
        return define(type_name, stage, call(self.name, *arguments))

    def _increment(self, state: str, by: Code) -> Plain:
        local = code(self.local(state))
        if is_single(self.types[state]):
            return store(local, self._rounded(state, infix("+", SUM, local, by)))
        return Plain(Assignment(local, by, "+="))

    def _rounded(self, state: str, value: Code) -> Code:
        return cast("float", value) if is_single(self.types[state]) else value

    def _euler(self, shared: list[Code], held: list[Code]) -> list[Statement]:
        states: list[Code] = [code(self.local(state)) for state in self._states_read]
        increments = [
            self._increment(state, infix("*", PRODUCT, Atom("h"), self._slope("k1", state))) for state in self.states
        ]
        return [self._evaluated("k1", states, Atom("t"), shared, held), *increments]

    def _runge_kutta(self, shared: list[Code], held: list[Code]) -> list[Statement]:
        statements: list[Statement] = []
        for stage, fraction in enumerate(("", "half", "half", "h")):
            at: list[Code] = [code(self.local(state)) for state in self._states_read]
            time: Code = Atom("t")
            if fraction:
                moved = [infix("*", PRODUCT, Atom(fraction), self._slope(f"k{stage}", s)) for s in self._states_read]
                at = [
                    self._rounded(state, infix("+", SUM, there, by))
                    for state, there, by in zip(self._states_read, at, moved, strict=True)
                ]
                time = infix("+", SUM, time, Atom(fraction))
            statements.append(self._evaluated(f"k{stage + 1}", at, time, shared, held))
        for state in self.states:
            k1, k2, k3, k4 = (self._slope(f"k{stage}", state) for stage in (1, 2, 3, 4))
            total = infix("+", SUM, k1, infix("*", PRODUCT, Atom("2.0"), k2))
            total = infix("+", SUM, total, infix("*", PRODUCT, Atom("2.0"), k3))
            statements.append(self._increment(state, infix("*", PRODUCT, Atom("sixth"), infix("+", SUM, total, k4))))
        return statements


def _fraction(of: str) -> Code:
    return infix("/", PRODUCT, Atom("h"), Atom(of))


def sub_steps(sample: Code, step: float) -> Code:
    """The number of steps of at most ``step`` nanoseconds in a sample period of ``sample`` seconds."""
    nanoseconds = infix("*", PRODUCT, sample, Atom("1e9"))
    return cast("int64_t", call("ceil", infix("/", PRODUCT, call("rint", nanoseconds), Atom(repr(step)))))


def steps_until_now(step: int | None) -> tuple[list[Statement], Code | None]:
    """The statements that define the length ``h`` of a step, of at most ``step`` nanoseconds, from the last instant of
    an environment until ``now``; and the number of steps, if it is not always 1.
    """
    elapsed = infix("-", SUM, Atom("now"), own("now"))
    interval = call("csp_seconds", elapsed)
    if step is None:
        return [define("const double", "h", interval)], None
    # Integer division, rounded up: exact, because the interval is not negative.
    count, longest = Atom("steps"), duration(step)
    rounded = infix("-", SUM, infix("+", SUM, elapsed, longest), Atom("1"))
    return [
        define("const int64_t", "steps", infix("/", PRODUCT, rounded, longest)),
        define("const double", "h", infix("/", PRODUCT, interval, cast("double", count))),
    ], count
