"""The abstract syntax of the programs that the oracle generates and runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

MS = 10**6
"""Nanoseconds, like all times."""

# ---- types ----


@dataclass(frozen=True)
class Int:
    name: str  # int, int8, uint16, ..., and time, which is whole nanoseconds

    @property
    def bounds(self) -> tuple[int, int]:
        if self.name in ("int", "time"):
            return -(2**63), 2**63 - 1
        bits = int(self.name.lstrip("uint"))
        return (0, 2**bits - 1) if self.name.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


@dataclass(frozen=True)
class Bool:
    name: str = "bool"


@dataclass(frozen=True)
class Real:
    name: str = "double"


@dataclass(frozen=True)
class Enum:
    name: str
    literals: tuple[str, ...]


@dataclass(frozen=True)
class Struct:
    name: str
    fields: tuple[tuple[str, Type], ...]


@dataclass(frozen=True)
class Array:
    element: Type
    size: int

    @property
    def name(self) -> str:
        return f"{self.element.name}[{self.size}]"


Type = Int | Bool | Real | Enum | Struct | Array
INT = Int("int")
TIME = Int("time")
REAL = Real()
BOOL = Bool()

CONSTANTS: tuple[tuple[int, Int], ...] = (
    *((number, INT) for number in (0, 1, 2, 3, 2**63 - 1, -(2**63), 2**63 - 2, 2**62, -(2**62))),
    *((number, TIME) for number in (2**63 - 1, -(2**63), 9223372036 * 10**9, 5 * MS)),
)
"""The values of the constants `k0`, `k1`, … of every program."""

# Values: int, bool, float, an enumeration's literal as `Mode.idle`, structs and arrays as tuples.
Value = int | bool | float | str | tuple["Value", ...]

# ---- expressions ----


@dataclass(frozen=True)
class Lit:
    value: Value
    type: Type
    constant: bool = False  # written as the name of a constant, or of a parameter


@dataclass(frozen=True)
class Ref:
    name: str
    type: Type


@dataclass(frozen=True)
class Field:
    of: Expr
    position: int
    name: str
    type: Type


@dataclass(frozen=True)
class Index:
    of: Expr
    at: Expr
    type: Type


@dataclass(frozen=True)
class Bin:
    op: str
    left: Expr
    right: Expr
    type: Type


@dataclass(frozen=True)
class Un:
    op: str  # `-`, `not`, `abs`
    of: Expr
    type: Type


@dataclass(frozen=True)
class Call:
    name: str  # min, max, limit, floor, sqrt
    arguments: tuple[Expr, ...]
    type: Type


@dataclass(frozen=True)
class Convert:
    of: Expr
    type: Int | Real


@dataclass(frozen=True)
class If3:
    condition: Expr
    yes: Expr
    no: Expr
    type: Type


@dataclass(frozen=True)
class Now:
    """The present instant."""

    type: Int = TIME


@dataclass(frozen=True)
class Make:
    """A struct or an array built from its parts."""

    parts: tuple[Expr, ...]
    type: Struct | Array


Expr = Lit | Ref | Field | Index | Bin | Un | Call | Convert | If3 | Now | Make

# ---- compositions ----


@dataclass(frozen=True)
class Target:
    """The target of an assignment: a variable, or one field or element of it."""

    name: str
    type: Type
    at: int | None = None  # the position of a field or an element
    part: str = ""  # `.x` or `[1]`


@dataclass(frozen=True)
class Skip:
    pass


@dataclass(frozen=True)
class Stop:
    pass


@dataclass(frozen=True)
class Assign:
    target: Target
    value: Expr


@dataclass(frozen=True)
class Read:
    channel: str
    target: Target


@dataclass(frozen=True)
class Write:
    channel: str
    value: Expr


@dataclass(frozen=True)
class Wait:
    time: int | Expr
    until: bool = False  # `time` is an instant


@dataclass(frozen=True)
class Raise:
    name: str


@dataclass(frozen=True)
class Run:
    law: str


@dataclass(frozen=True)
class Reset:
    law: str


@dataclass(frozen=True)
class Seq:
    parts: tuple[Comp, ...]


@dataclass(frozen=True)
class Par:
    parts: tuple[Comp, ...]
    prioritized: bool = False


@dataclass(frozen=True)
class After:
    time: int | Expr
    at: bool = False  # `time` is an instant


@dataclass(frozen=True)
class Ready:
    """A guard that is a sampled port alone; the guarded process begins with a law that reads it."""

    channel: str


Event = Read | Write | After | Skip | Ready


@dataclass(frozen=True)
class Guarded:
    event: Event
    body: Comp
    when: Expr | None = None


@dataclass(frozen=True)
class Alt:
    branches: tuple[Guarded, ...]
    prioritized: bool = False


@dataclass(frozen=True)
class Mu:
    body: Comp
    until: Expr | None = None


@dataclass(frozen=True)
class While:
    condition: Expr
    body: Comp


@dataclass(frozen=True)
class If:
    condition: Expr
    yes: Comp
    no: Comp | None = None


@dataclass(frozen=True)
class Catch:
    body: Comp
    name: str
    handler: Comp


@dataclass(frozen=True)
class Interrupt:
    body: Comp
    guard: Guarded  # its body is the handler


@dataclass(frozen=True)
class Replicated:
    """`seq`, `par`, `alt`, … of one body; an `alt` has a guarded body."""

    operator: str
    variable: str
    count: int
    body: Comp


Comp = (
    Skip | Stop | Assign | Read | Write | Wait | Raise | Run | Reset | Seq | Par | Guarded | Alt | Mu | While | If
    | Catch | Interrupt | Replicated
)  # fmt: skip

# ---- programs ----


@dataclass(frozen=True)
class Channel:
    name: str
    type: Type
    kind: str  # sync, any, broadcast, buffer, overwrite
    size: int = 0


@dataclass(frozen=True)
class Variable:
    name: str
    type: Type
    initial: Value
    owner: int  # the branch of the outermost parallel that uses it


@dataclass(frozen=True)
class Port:
    name: str
    input: bool
    type: Type
    period: int | None = None  # nanoseconds
    immediate: bool = False
    values: tuple[tuple[int, Value], ...] = ()  # from an instant on, the value that the environment offers
    domain: tuple[Value, ...] = ()  # representative values, in a general environment
    offset: int = 0  # nanoseconds, shorter than the period

    @property
    def ticks(self) -> tuple[int, int] | None:
        """The instants of two ports are equal if this is equal: the period and the offset."""
        return (self.period, self.offset) if self.period else None


@dataclass(frozen=True)
class Law:
    """An instance of a submodel that is defined for this instance only."""

    name: str
    inputs: tuple[tuple[str, Type, str], ...]  # name, type, the port or variable that it reads
    outputs: tuple[tuple[str, Type, str, Expr], ...]  # name, type, the port or variable written, the equation
    states: tuple[tuple[str, Type, Value, Expr], ...]  # name, type, initial value, the next value
    wcet: int | None
    owner: int


@dataclass(frozen=True)
class Program:
    body: Comp
    channels: tuple[Channel, ...] = ()
    variables: tuple[Variable, ...] = ()
    ports: tuple[Port, ...] = ()
    laws: tuple[Law, ...] = ()
    enums: tuple[Enum, ...] = ()
    structs: tuple[Struct, ...] = ()
    exceptions: tuple[str, ...] = ()
    step: int | None = None  # of the environment
    boxed: frozenset[int] = frozenset()  # branches of the outermost parallel that are processes of their own
    name: str = "Main"
    environment: bool = True
    tags: frozenset[str] = field(default_factory=frozenset)


def parts(node: Comp) -> tuple[Comp, ...]:
    """The compositions directly within one."""
    match node:
        case Seq(inner) | Par(inner):
            return inner
        case Alt(branches):
            return branches
        case Guarded(_, body) | Mu(body) | While(_, body) | Replicated(_, _, _, body):
            return (body,)
        case If(_, yes, no):
            return (yes,) if no is None else (yes, no)
        case Catch(body, _, handler):
            return (body, handler)
        case Interrupt(body, guard):
            return (body, guard)
        case _:
            return ()


def with_parts(node: Comp, new: tuple[Comp, ...]) -> Comp:
    """The same composition with other parts."""
    match node:
        case Seq() | Par():
            return replace(node, parts=new)
        case Alt():
            return replace(node, branches=tuple(part for part in new if isinstance(part, Guarded)))
        case Guarded() | Mu() | While() | Replicated():
            return replace(node, body=new[0])
        case If():
            return replace(node, yes=new[0], no=new[1] if len(new) > 1 else None)
        case Catch():
            return replace(node, body=new[0], handler=new[1])
        case Interrupt():
            assert isinstance(new[1], Guarded)
            return replace(node, body=new[0], guard=new[1])
        case _:
            return node


def walk(node: Comp) -> list[Comp]:
    found: list[Comp] = [node]
    for part in parts(node):
        found += walk(part)
    return found


def changed_at(node: Comp, number: int, change: Callable[[Comp], Comp]) -> Comp:
    """The composition with part `number`, in the order of the text, changed."""
    found = walk(node)[number]

    def put(part: Comp) -> Comp:
        if part is found:
            return change(part)
        return with_parts(part, tuple(put(inner) for inner in parts(part)))

    return put(node)


def early(instant: int) -> Bin:
    """Whether an instant has not been reached: `now < 5 ms`."""
    return Bin("<", Now(), Lit(instant, TIME), BOOL)
