"""What a part of a random program may use: ends of channels, outputs, and variables of its own."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isqrt
from random import Random

from tests.oracle.machine.values import zero
from tests.oracle.programs.tree import (
    BOOL,
    CONSTANTS,
    INT,
    MS,
    REAL,
    TIME,
    Array,
    Bin,
    Bool,
    Call,
    Channel,
    Convert,
    Enum,
    Expr,
    Field,
    If3,
    Index,
    Int,
    Law,
    Lit,
    Make,
    Real,
    Ref,
    Struct,
    Target,
    Type,
    Un,
    Value,
    Variable,
)  # fmt: skip

MODE = Enum("Mode", ("low", "mid", "high"))
PAIR = Struct("Pair", (("a", INT), ("b", BOOL)))
TWO = Array(INT, 2)
BYTE = Int("int8")
NARROW = (BYTE, *(Int(name) for name in ("int16", "int32", "uint8", "uint16", "uint32")))
TYPES: tuple[Type, ...] = (INT, BOOL, REAL, MODE, PAIR, TWO)
WIDE_TYPES: tuple[Type, ...] = (*(INT,) * 8, TIME, TIME, REAL, BYTE, *NARROW)
REALS = (0.0, 0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 1e300)


@dataclass
class World:
    """A program that is being generated."""

    rng: Random
    variables: list[Variable] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)
    exceptions: set[str] = field(default_factory=set)
    rich: bool = True  # with structs, arrays, enumerations
    wide: bool = False  # with numbers at the ends of the ranges of their types
    laws: list[Law] = field(default_factory=list)

    def variable(self, kind: Type, owner: int, initial: Value | None = None) -> Variable:
        made = Variable(f"v{len(self.variables)}", kind, zero(kind) if initial is None else initial, owner)
        self.variables.append(made)
        return made


@dataclass
class Scope:
    world: World
    owner: int
    reads: list[Channel]
    writes: list[Channel]
    outputs: list[str]
    own: list[Variable] = field(default_factory=list)

    @property
    def rng(self) -> Random:
        return self.world.rng

    def variable(self, kind: Type) -> Variable:
        """A variable of this part and this type, declared if there is none."""
        known = [variable for variable in self.own if variable.type == kind]
        if known and self.rng.random() < 0.8:
            return self.rng.choice(known)
        wide = self.world.wide and isinstance(kind, Int) and self.rng.random() < 0.15
        made = self.world.variable(kind, self.owner, self.edge(kind).value if wide else None)
        self.own.append(made)
        return made

    def target(self, kind: Type) -> Target:
        """The target for a value of a type: a variable, or a field or an element of one."""
        if kind == INT and self.world.rich and self.rng.random() < 0.15:
            at = self.rng.randrange(2)
            return Target(self.variable(TWO).name, INT, at, f"[{at}]")
        return Target(self.variable(kind).name, kind)

    def split(self, count: int) -> list[Scope]:
        """Scopes for parallel branches, which share nothing."""
        made = [Scope(self.world, self.owner, [], [], []) for _ in range(count)]
        for channel in self.reads:
            self.rng.choice(made).reads.append(channel)
        for channel in self.writes:
            self.rng.choice(made).writes.append(channel)
        for output in self.outputs:
            self.rng.choice(made).outputs.append(output)
        return made

    # ---- expressions, with few values so that explorations end ----

    def number(self, depth: int = 1) -> Expr:
        rng = self.rng
        choice = rng.random()
        known = [variable for variable in self.own if variable.type == INT]
        if choice < 0.35 or not known:
            return Lit(rng.randrange(4), INT, constant=choice < 0.08)
        ref = Ref(rng.choice(known).name, INT)
        if choice < 0.6 or depth == 0:
            return ref
        if choice < 0.75:
            step = Bin("+", ref, Lit(rng.randrange(1, 3), INT), INT)
            return Bin("%", step, Lit(rng.randrange(2, 4), INT), INT)
        if choice < 0.85:
            moved = Bin(rng.choice("+-*"), ref, self.number(depth - 1), INT)
            return Call("limit", (moved, Lit(0, INT), Lit(3, INT)), INT)
        if choice < 0.92 and self.world.rich:
            pairs = [variable for variable in self.own if variable.type == PAIR]
            arrays = [variable for variable in self.own if variable.type == TWO]
            if pairs:
                return Field(Ref(rng.choice(pairs).name, PAIR), 0, "a", INT)
            if arrays:
                return Index(Ref(rng.choice(arrays).name, TWO), Lit(rng.randrange(2), INT), INT)
        return If3(self.condition(depth - 1), self.number(0), self.number(0), INT)

    def real(self, depth: int = 2) -> Expr:
        """A real expression, also with few values, but rounded."""
        rng = self.rng
        choice = rng.random()
        known = [variable for variable in self.own if variable.type == REAL]
        if choice < 0.3 or not known:
            numbers = [variable for variable in self.own if variable.type == INT]
            if numbers and choice < 0.1:
                return Convert(Ref(rng.choice(numbers).name, INT), REAL)
            return Lit(rng.choice(REALS), REAL)
        ref = Ref(rng.choice(known).name, REAL)
        if choice < 0.5 or depth == 0:
            return ref
        if choice < 0.6:
            return Call("floor", (self.real(depth - 1),), REAL)
        if choice < 0.65:
            return Call("sqrt", (self.real(depth - 1),), REAL)
        if choice < 0.75:
            return If3(self.condition(0), ref, self.real(0), REAL)
        moved = Bin(rng.choice("+-*/"), ref, self.real(depth - 1), REAL)
        if choice < 0.8:
            return moved
        return Call("limit", (moved, Lit(0.0, REAL), Lit(3.0, REAL)), REAL)

    def value(self, kind: Type) -> Expr:
        rng = self.rng
        known = [variable for variable in self.own if variable.type == kind]
        if known and rng.random() < 0.35:
            return Ref(rng.choice(known).name, kind)
        match kind:
            case Real():
                return self.real()
            case Bool():
                return self.condition() if rng.random() < 0.5 else Lit(rng.random() < 0.5, BOOL)
            case Enum(name, literals):
                return Lit(f"{name}.{rng.choice(literals)}", kind)
            case Struct(_, fields):
                return Make(tuple(self.value(inner) for _, inner in fields), kind)
            case Array(element, size):
                return Make(tuple(self.value(element) for _ in range(size)), kind)
            case Int() if self.world.wide and (kind == TIME or rng.random() < 0.3):
                return self.edge(kind)
            case Int("int"):
                return self.number()
            case Int():
                return Convert(Bin("%", Call("max", (self.number(), Lit(0, INT)), INT), Lit(4, INT), INT), kind)

    def edge(self, kind: Int) -> Lit:
        """A number at an end of the range of its type, at half of it or its root, or a small one."""
        rng = self.rng
        low, high = kind.bounds
        named = [value for value, other in CONSTANTS if other == kind]
        if named and rng.random() < 0.2:
            return Lit(rng.choice(named), kind, constant=True)
        choice = rng.random()
        if choice < 0.35:
            return Lit(rng.choice((low, low + 1, low + 2, high, high - 1, high - 2)), kind)
        if choice < 0.6:
            part = rng.choice((high // 2, high // 2 + 1, high // 3, isqrt(high), isqrt(high) + 1, high - 100))
            return Lit(-part if low and rng.random() < 0.4 else part, kind)
        size = rng.choice((1, 2, 3, 10)) * (rng.choice((1, MS)) if kind == TIME else 1)
        return Lit(-size if low and rng.random() < 0.3 else size, kind)

    def condition(self, depth: int = 1) -> Expr:
        rng = self.rng
        known = [variable for variable in self.own if variable.type in (INT, BOOL, REAL, MODE)]
        if not known:
            return Lit(rng.random() < 0.5, BOOL)
        variable = rng.choice(known)
        ref = Ref(variable.name, variable.type)
        if variable.type == BOOL:
            return ref if rng.random() < 0.5 else Un("not", ref, BOOL)
        if variable.type == MODE:
            return Bin(rng.choice(["==", "!="]), ref, Lit(f"Mode.{rng.choice(MODE.literals)}", MODE), BOOL)
        if variable.type == REAL:
            return Bin(rng.choice(["==", "!=", "<", ">="]), ref, Lit(rng.choice((0.3, *REALS)), REAL), BOOL)
        simple = Bin(rng.choice(["==", "!=", "<", "<=", ">", ">="]), ref, Lit(rng.randrange(3), INT), BOOL)
        if depth and rng.random() < 0.15:
            return Bin(rng.choice(["and", "or"]), simple, self.condition(0), BOOL)
        return simple
