"""Random arithmetic at the ends of the ranges of its types: some of it faults, some of it just avoids a fault.

What a variable is set to depends on its previous value only if it grows until it faults, so explorations end.
"""

from __future__ import annotations

from tests.oracle.programs.scope import NARROW, PAIR, TWO, Scope
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    REAL,
    TIME,
    Assign,
    Bin,
    Comp,
    Convert,
    Expr,
    Field,
    If,
    Index,
    Int,
    Law,
    Lit,
    Make,
    Mu,
    Ref,
    Run,
    Seq,
    Skip,
    Target,
    Un,
    Value,
    Wait,
    While,
)  # fmt: skip

COMPARED = ("==", "!=", "<", "<=", ">", ">=")
HUGE_REALS = (1e300, -1e300, 1e308, 1e154, 1.5e154, 2.0**63, -(2.0**63), 2.0**62, 1e19, 0.0, 127.5, -1.0)


class Edges:
    def __init__(self, scope: Scope, without: frozenset[str]) -> None:
        self.scope = scope
        self.rng = scope.rng
        self.without = without

    def kind(self) -> Int:
        choice = self.rng.random()
        return INT if choice < 0.6 else TIME if choice < 0.75 else self.rng.choice(NARROW)

    # ---- expressions ----

    def fresh(self, kind: Int | None, initial: Value, *, pair: bool = False) -> Ref:
        """A variable of its own; for pairs of numbers without a type, or for a struct."""
        made = self.scope.world.variable(kind or (PAIR if pair else TWO), self.scope.owner, initial)
        return Ref(made.name, made.type)

    def place(self, kind: Int) -> Expr:
        """A variable, a field or an element, with a value at an end of the range."""
        initial = self.scope.edge(kind).value
        known = [variable for variable in self.scope.own if variable.type == kind]
        choice = self.rng.random()
        if known and choice < 0.35:
            return Ref(self.rng.choice(known).name, kind)
        if kind == INT and choice > 0.9:
            other = self.scope.edge(INT).value
            return Index(self.fresh(None, (other, initial)), Lit(1, INT), INT)
        if kind == INT and choice > 0.85:
            return Field(self.fresh(None, (initial, True), pair=True), 0, "a", INT)
        if kind not in (INT, TIME) and choice > 0.8:
            other_kind = self.rng.choice((INT, *NARROW))
            return Convert(self.fresh(other_kind, self.scope.edge(other_kind).value), kind)
        if kind == INT and choice > 0.75:
            narrow = self.rng.choice(NARROW)
            return Convert(self.fresh(narrow, self.scope.edge(narrow).value), INT)
        return self.fresh(kind, initial)

    def operand(self, kind: Int) -> Expr:
        choice = self.rng.random()
        found: Expr = self.scope.edge(kind) if choice < 0.6 else self.place(kind)
        if choice > 0.9 and kind.bounds[0]:
            return Un(self.rng.choice(("-", "abs")), found, kind)
        return found

    def sum(self, kind: Int, depth: int = 1) -> Expr:
        """A sum, or another result that may be out of range."""
        choice = self.rng.random()
        first = self.sum(kind, 0) if depth and choice < 0.15 else self.place(kind)
        if choice > 0.95 and kind.bounds[0]:
            return Un(self.rng.choice(("-", "abs")), first, kind)
        if choice > 0.9 and kind == INT:
            return Bin("^", first, Lit(self.rng.choice((0, 1, 2, 3, 62, 63, 64)), INT), INT)
        if choice > 0.85:
            return Bin("*", first, self.operand(INT if kind == TIME else kind), kind)
        if choice > 0.8 and kind != TIME:
            return Bin(self.rng.choice("/%"), first, self.operand(kind), kind)
        return Bin(self.rng.choice("++-"), first, self.operand(kind), kind)

    def condition(self) -> Expr:
        kind = self.kind()
        known = [variable for variable in self.scope.own if isinstance(variable.type, Int)]
        if known and self.rng.random() < 0.4:
            variable = self.rng.choice(known)
            return self.compared(Ref(variable.name, variable.type))
        return Bin(self.rng.choice(COMPARED), self.sum(kind), self.scope.edge(kind), BOOL)

    def compared(self, value: Expr) -> Expr:
        """A comparison of a value with something added or subtracted."""
        kind = value.type
        assert isinstance(kind, Int)
        moved = Bin(self.rng.choice("+-"), value, self.scope.edge(kind), kind)
        return Bin(self.rng.choice(COMPARED), moved, self.scope.edge(kind), BOOL)

    # ---- steps ----

    def added(self, target: Target) -> Comp:
        """The value of a variable with something added that takes it near an end of the range, or beyond; or a
        comparison with it.
        """
        kind = target.type
        assert isinstance(kind, Int)
        value: Expr = Ref(target.name, kind)
        if target.at is not None:
            value = Index(Ref(target.name, TWO), Lit(target.at, INT), INT)
        if self.rng.random() < 0.4:
            return If(self.compared(value), Skip())
        end = self.rng.choice(kind.bounds) or kind.bounds[1]
        op = "+" if end > 0 else "-"
        reach = min(abs(end), kind.bounds[1]) - self.rng.randrange(4)
        into = target if target.at is not None else Target(self.fresh(kind, 0).name, kind)
        return Assign(into, Bin(op, value, Lit(reach, kind), kind))

    def steps(self) -> list[Comp]:
        choice = self.rng.random()
        kind = self.kind()
        if choice < 0.3:
            return [Assign(Target(self.fresh(kind, 0).name, kind), self.sum(kind))]
        if choice < 0.45:
            return [self.creeping(kind)]
        if choice < 0.55:
            return [self.converted()]
        if choice < 0.65:
            return [self.infinite()]
        if choice < 0.72:
            values = Make((self.sum(INT), Lit(True, BOOL)), PAIR)
            return [Assign(Target(self.fresh(None, (0, False), pair=True).name, PAIR), values)]
        if choice < 0.8:
            array = self.fresh(None, (self.scope.edge(INT).value, self.scope.edge(INT).value))
            first, second = (Index(array, Lit(at, INT), INT) for at in (0, 1))
            return [Assign(Target(array.name, INT, 0, "[0]"), Bin(self.rng.choice("+-"), first, second, INT))]
        if choice < 0.9 and "law" not in self.without:
            return [self.in_law()]
        return [If(self.condition(), Skip())]

    def creeping(self, kind: Int) -> Comp:
        """Closer to an end of the range each time."""
        low, high = kind.bounds
        by = self.rng.randint(1, 3)
        far = self.rng.randrange(4 * by)
        up = self.rng.random() < 0.6
        ref = self.fresh(kind, high - far if up else low + far)
        return Assign(Target(ref.name, kind), Bin("+" if up else "-", ref, Lit(by, kind), kind))

    def converted(self) -> Comp:
        """A number into a narrower type, or a real into a whole one."""
        kind = self.rng.choice((INT, *NARROW))
        into = Target(self.fresh(kind, 0).name, kind)
        if self.rng.random() < 0.4:
            return Assign(into, Convert(self.real(), kind))
        other = self.rng.choice((INT, *NARROW))
        return Assign(into, Convert(self.sum(other) if self.rng.random() < 0.5 else self.place(other), kind))

    def real(self) -> Expr:
        variable = self.scope.world.variable(REAL, self.scope.owner, self.rng.choice(HUGE_REALS))
        return Ref(variable.name, REAL)

    def infinite(self) -> Comp:
        """A real that may be infinite, or not a number, where it is stored, or where it is only compared."""
        by: Expr = Lit(abs(self.rng.choice(HUGE_REALS)), REAL) if self.rng.random() < 0.5 else self.real()
        made = Bin(self.rng.choice("+-*/"), self.real(), by, REAL)
        if self.rng.random() < 0.25:
            return If(Bin(self.rng.choice(("<", ">")), made, Lit(1.0, REAL), BOOL), Skip())
        return Assign(Target(self.scope.world.variable(REAL, self.scope.owner, 0.5).name, REAL), made)

    def in_law(self) -> Comp:
        """A law that computes a sum, of its input and perhaps of a state."""
        given, into = self.fresh(INT, self.scope.edge(INT).value), self.fresh(INT, 0)
        laws = self.scope.world.laws
        value = Bin(self.rng.choice("+-*"), Ref("x", INT), self.scope.edge(INT), INT)
        state: tuple[tuple[str, Int, Value, Expr], ...] = ()
        if self.rng.random() < 0.4:
            edge = self.scope.edge(INT)
            state = (("s", INT, edge.value, Bin("+", Ref("s", INT), Ref("x", INT), INT)),)
            value = Bin("+", value, Ref("s", INT), INT)
        outputs = (("y", INT, into.name, value),)
        laws.append(Law(f"law{len(laws)}", (("x", INT, given.name),), outputs, state, None, self.scope.owner))
        return Run(laws[-1].name)

    # ---- loops ----

    def spin(self, communication: Comp | None) -> Comp:
        """A loop that never ends, and at most waits for others."""
        if communication is not None and self.rng.random() < 0.6:
            return Mu(communication)
        ref = self.fresh(INT, 0)
        return Mu(Assign(Target(ref.name, INT), Lit(0, INT)), Bin(">", ref, Lit(0, INT), BOOL))

    def growth(self, kind: Int) -> tuple[Ref, list[Comp]]:
        """A variable, and steps after which it is much larger, or much smaller."""
        way = self.rng.randrange(7)
        start = self.rng.choice((1, 1, 2, 3, 5))
        if kind in (INT, TIME) and self.rng.random() < 0.6:
            start = 2 ** self.rng.choice((40, 55, 58, 60, 61, 62))
        if kind.bounds[0] and self.rng.random() < 0.35:
            start = -start
        ref = self.fresh(kind, start)
        target = Target(ref.name, kind)

        def becomes(op: str, by: Expr) -> list[Comp]:
            return [Assign(target, Bin(op, ref, by, kind))]

        match way:
            case 0 if kind != TIME:
                return ref, becomes("*", ref)
            case 1:
                other = self.fresh(kind, start)
                return ref, [*becomes("+", other), Assign(Target(other.name, kind), Bin("+", ref, other, kind))]
            case 2:
                return ref, becomes("*", Lit(self.rng.choice((2, 3, -2) if kind.bounds[0] else (2, 3)), INT))
            case 3 if kind in (INT, TIME):
                up = start > 0
                by = 2**62 - self.rng.randrange(5) if self.rng.random() < 0.5 else 2**60
                return ref, becomes("+" if up else "-", Lit(by, kind))
            case 4 if kind in (INT, TIME):
                other = self.fresh(kind, 2 ** self.rng.choice((58, 60, 62)))
                return ref, becomes("+" if start > 0 else "-", other)
            case _:
                return ref, becomes("+", ref)

    def loop(self, inner: list[Comp]) -> list[Comp]:
        """A loop in which a number grows: up to a bound, a number of times, or until it faults."""
        kind = self.kind()
        ref, steps = self.growth(kind)
        body = Seq((*steps, *inner) if self.rng.random() < 0.5 else (*inner, *steps))
        choice = self.rng.random()
        if choice < 0.25 and (inner or "time" not in self.without):
            return [Mu(body if inner else Seq((*steps, Wait(MS))))]
        bound = self.scope.edge(kind)
        compared: Expr = ref
        if self.rng.random() < 0.25:
            compared = Bin(self.rng.choice("+-"), ref, self.operand(kind), kind)
        if choice < 0.6:
            return [While(Bin(self.rng.choice(("<", "<", ">", "!=")), compared, bound, BOOL), body)]
        if choice < 0.8:
            return [Mu(body, Bin(self.rng.choice((">", ">=", "<", "==")), compared, bound, BOOL))]
        counter = self.fresh(INT, 0)
        count = Assign(Target(counter.name, INT), Bin("+", counter, Lit(1, INT), INT))
        return [Mu(Seq((*body.parts, count)), Bin(">=", counter, Lit(self.rng.randint(1, 4), INT), BOOL))]
