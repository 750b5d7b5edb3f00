"""Random well-typed programs, as text, with all constructs of the language.

A program is a few leaf processes in parallel, joined by channels of all kinds, with sampled and event ports to an
environment. Every process uses each of its ports; loops are bounded or contain a delay. Such a program may deadlock,
miss a sample or overflow: each of these is an outcome like any other, and has to be the same on every run and target.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hypothesis import strategies as st

TYPES = ("int", "double", "bool", "int16", "Mode")
INITIAL = {"int": "0", "double": "0.0", "bool": "false", "int16": "int16(0)", "Mode": "Mode.idle"}


PARAMETERS = """struct Pair { gain: double  step: int16 }
parameter p_int : int = 2
parameter p_bool : bool = true
parameter p_Mode : Mode = Mode.run
parameter pair : Pair = Pair(gain = 0.75, step = 4)
const followed = pair.gain * 2 + 0.25"""

LAW = """submodel Law(gain: double = 0.75) {
    in x : double
    out y : double
    state s : double = 0.25
    let smooth = lag(x, 4 ms)
    let rate = derivative(smooth) * 1 ms
    next s = s + gain * (smooth - s)
    y = limit(s + pre(x, 0.0) - rate, -5.0, 5.0)
}"""

CELLS = """process Cell(id: int) {
    out number : int
    communication { var n : int = 0 }
    composition { while n < 3 do (number ! n * 10 + id ; n := n + 1 ; wait 2 ms) }
}

process Collector(size: int) {
    in number[size] : int
    communication { var got : int = 0  var last : int = 0 }
    composition { mu ((alt i < size : number[i] ? last -> skip) ; got := got + 1) until got == 3 * size }
}

process Worker {
    in order : int
    communication { var n : int = 0 }
    composition { mu (order ? n ; wait 1 ms * n) until n == 0 }
}

process Distributor(size: int) {
    out order[size] : int
    communication { var given : int = 0 }
    composition {
        mu ((prialt i < size : order[i] ! i + 1 -> skip) ; given := given + 1) until given == 5 * size ;
        (par i < size : order[i] ! 0)
    }
}"""


@dataclass
class Leaf:
    """A process under construction: its ports with their types and the statements that use them."""

    name: str
    inputs: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    law: bool = False
    """Whether a submodel reads ``sample_in`` and writes ``sample_out``."""
    turns: int | None = None
    """In a calm program: every process communicates in the order of the channels, this many times."""


def value(draw: st.DrawFn, kind: str, depth: int = 2) -> str:
    """An expression of a type over the variables ``v_<type>`` and ``n``."""
    if depth == 0 or draw(st.booleans()):
        literals = {
            "int": st.sampled_from(["0", "1", "7", "-3", "n", "v_int", "p_int"]),
            "double": st.sampled_from(["0.5", "1.25", "-2.0", "v_double", "followed", "pair.gain"]),
            "bool": st.sampled_from(["true", "false", "v_bool", "p_bool"]),
            "int16": st.sampled_from(["int16(3)", "v_int16", "pair.step"]),
            "Mode": st.sampled_from(["Mode.idle", "Mode.run", "v_Mode", "p_Mode"]),
        }
        return draw(literals[kind])
    inner = lambda k: value(draw, k, depth - 1)  # noqa: E731
    match kind:
        case "int":
            form = draw(st.sampled_from(["({} + {})", "({} - {})", "({} * {})", "({} % 5 + {})", "max({}, {})"]))
            return form.format(inner("int"), inner("int"))
        case "double":
            form = draw(st.sampled_from(["({} + {})", "({} * {})", "limit({}, -10.0, 10.0 + abs({}))", "min({}, {})"]))
            return form.format(inner("double"), inner("double"))
        case "bool":
            form = draw(st.sampled_from(["({} < {})", "({} == {})", "({} >= {})"]))
            return form.format(inner("int"), inner("int"))
        case _:
            return f"(if {inner('bool')} then {inner(kind)} else {inner(kind)})"


def number(statement: str) -> int:
    """The number of the channel over which a statement communicates, by which statements are ordered."""
    digits = "".join(character for character in statement.partition(" ")[0] if character.isdigit())
    return int(digits) if digits and statement[0] in "io" else 99


def use_inputs(draw: st.DrawFn, leaf: Leaf) -> list[str]:
    """Statements that read every input, one by one or in an alternative."""
    plain = {name: kind for name, kind in leaf.inputs.items() if not (leaf.law and name == "sample_in")}
    if leaf.turns is not None:
        return [f"{name} ? v_{kind}" for name, kind in plain.items() if name != "button"]
    statements = []
    if len(plain) >= 2 and draw(st.booleans()):
        operator = draw(st.sampled_from(["[]", "[]>"]))
        branches = [f"({guard(draw, name, kind)} -> {small_step(draw)})" for name, kind in plain.items()]
        if draw(st.booleans()):
            branches.append(f"(after {draw(st.sampled_from([1, 3, 10]))} ms -> skip)")
        count = draw(st.integers(1, 4))
        statements.append(f"(n := 0 ; (mu (({f' {operator} '.join(branches)}) ; n := n + 1) until n >= {count}))")
    else:
        statements += [f"{name} ? v_{kind}" for name, kind in plain.items()]
    return statements


def guard(draw: st.DrawFn, name: str, kind: str) -> str:
    """An input guard, with or without a condition that can hold."""
    condition = "when n < 100 & " if draw(st.booleans()) else ""
    return f"{condition}{name} ? v_{kind}"


def small_step(draw: st.DrawFn) -> str:
    """A step without communication."""
    kind = draw(st.sampled_from(TYPES))
    return draw(
        st.sampled_from(
            [
                "skip",
                "wait 1 ms",
                f"v_{kind} := {value(draw, kind)}",
                f"(if {value(draw, 'bool')} then skip else wait 2 ms)",
            ]
        )
    )


def body(draw: st.DrawFn, leaf: Leaf) -> str:
    """A composition that uses every port, decorated with loops, exceptions and interrupts."""
    steps = use_inputs(draw, leaf)
    steps += [
        f"{name} ! {value(draw, kind)}"
        for name, kind in leaf.outputs.items()
        if not (leaf.law and name == "sample_out")
    ]
    steps += [small_step(draw) for _ in range(draw(st.integers(0, 2)))]
    if leaf.law:
        steps.append(draw(st.sampled_from(["law", "(sample_in -> law)", "(law ; reset law)"])))
    if leaf.turns is not None:
        return calm_body(draw, leaf, sorted(steps, key=number))
    order = draw(st.permutations(steps)) or ["skip"]
    text = " ; ".join(f"({step})" for step in order) if len(order) > 1 else f"{order[0]} ; skip"
    return decorated(draw, text)


def calm_body(draw: st.DrawFn, leaf: Leaf, steps: list[str]) -> str:
    """A loop over the channels in their order, so the rendezvous of all processes fit together."""
    if "button" in leaf.inputs:
        button = f"((button ? v_int -> {small_step(draw)}) []> (after 1 ms -> skip))"
        steps = [*steps, button]
    text = " ; ".join(f"({step})" for step in [*steps, "k := k + 1", "wait 1 ms"])
    return f"(mu ({text}) until k >= {leaf.turns})"


def decorated(draw: st.DrawFn, text: str) -> str:
    """A sequence inside a loop, an exception handler, an interrupt, a replicator or a group."""
    match draw(st.sampled_from(["once", "mu", "while", "catch", "raise", "interrupt", "seq", "group"])):
        case "mu":
            turns = draw(st.integers(1, 5))
            return f"(k := 0 ; (mu (({text}) ; k := k + 1 ; wait 1 ms) until k >= {turns}))"
        case "while":
            return f"(k := 0 ; (while k < {draw(st.integers(0, 4))} do (({text}) ; k := k + 1 ; wait 1 ms)))"
        case "catch":
            name = draw(st.sampled_from(["Overheated", "Fault", "Timeout"]))
            return f"(({text}) catch {name} -> (k := 99))"
        case "raise":
            return f"((({text}) ; (if {value(draw, 'bool')} then raise Overheated)) catch Overheated -> skip)"
        case "interrupt":
            return f"(({text}) interrupt after {draw(st.integers(1, 20))} ms -> skip)"
        case "seq":
            return f"(seq i < {draw(st.sampled_from([1, 2, 3, 17, 200]))} : ({text}))"
        case "group":
            return f"(work: ({text}))"
        case _:
            return f"({text})"


def leaf_text(draw: st.DrawFn, leaf: Leaf) -> str:
    """The definition of a leaf process."""
    ports = [f"    in {name} : {kind}" for name, kind in leaf.inputs.items()]
    ports += [f"    out {name} : {kind}" for name, kind in leaf.outputs.items()]
    variables = [f"        var v_{kind} : {kind} = {INITIAL[kind]}" for kind in TYPES]
    variables += ["        var n : int = 0", "        var k : int = 0"]
    if leaf.law:
        variables += [
            f"        law : Law{draw(st.sampled_from(['', '(pair.gain)', '(gain = 1 - followed)']))}",
            "        sample_in -> law.x",
            "        law.y -> sample_out",
        ]
    return "\n".join(
        [
            f"process {leaf.name} {{",
            *ports,
            "    communication {",
            *variables,
            "    }",
            "    composition {",
            f"        {body(draw, leaf)}",
            "    }",
            "}",
        ]
    )


@st.composite
def programs(draw: st.DrawFn) -> str:
    """An entire program with its environment ``Bench``."""
    turns = draw(st.none() | st.integers(1, 6))
    leaves = [Leaf(f"Leaf{i}", turns=turns) for i in range(draw(st.integers(2, 4)))]
    relations: list[str] = []
    for number in range(draw(st.integers(1, 5))):
        writer, reader = draw(st.permutations(range(len(leaves))))[:2]
        kind = draw(st.sampled_from(TYPES))
        channel_kind = draw(st.sampled_from(["", "", "buffer 2", "overwrite 3"]))
        leaves[writer].outputs[f"o{number}"] = kind
        leaves[reader].inputs[f"i{number}"] = kind
        arrow = f"-> c{number} : {kind} {channel_kind}".rstrip()
        relations.append(f"leaf{writer}.o{number} {arrow} -> leaf{reader}.i{number}")
    if turns is None and len(leaves) >= 3 and draw(st.booleans()):
        one, two, three = draw(st.permutations(range(len(leaves))))[:3]
        shared = draw(st.sampled_from(["any", "broadcast"]))
        if shared == "any":
            leaves[one].outputs["m"] = leaves[two].outputs["m"] = "int"
            leaves[three].inputs["m"] = "int"
            relations.append(f"leaf{one}.m, leaf{two}.m -> any -> leaf{three}.m")
        else:
            leaves[one].outputs["m"] = "int"
            leaves[two].inputs["m"] = leaves[three].inputs["m"] = "int"
            relations.append(f"leaf{one}.m -> broadcast -> leaf{two}.m, leaf{three}.m")
    period = draw(st.sampled_from(["1 ms", "2 ms", "5 ms"]))
    sampler = draw(st.integers(0, len(leaves) - 1))
    leaves[sampler].law = draw(st.booleans())
    leaves[sampler].inputs["sample_in"] = "double"
    leaves[sampler].outputs["sample_out"] = "double"
    button = draw(st.integers(0, len(leaves) - 1))
    leaves[button].inputs["button"] = "int"
    relations += [
        f"level -> leaf{sampler}.sample_in",
        f"leaf{sampler}.sample_out -> drive",
        f"press -> leaf{button}.button",
    ]
    operator = draw(st.sampled_from(["||", "||>"]))
    cells = draw(st.integers(0, 3))
    definitions = [leaf_text(draw, leaf) for leaf in leaves]
    instances = "\n".join(f"        leaf{i} : Leaf{i}" for i in range(len(leaves)))
    if cells:
        instances += f"\n        cell[i < {cells}] : Cell(id = i)\n        collector : Collector({cells})"
        relations.append(f"for i < {cells} {{ cell[i].number -> collector.number[i] }}")
    workers = draw(st.integers(0, 2))
    if workers:
        instances += f"\n        worker[i < {workers}] : Worker\n        distributor : Distributor({workers})"
        relations.append(f"for i < {workers} {{ distributor.order[i] -> worker[i].order }}")
    arrows = "\n".join(f"        {relation}" for relation in relations)
    parts = [f"leaf{i}" for i in range(len(leaves))]
    parts += [f"({draw(st.sampled_from(['par', 'pripar']))} i < {cells} : cell[i])", "collector"] if cells else []
    parts += ["(par i < {workers} : worker[i])".replace("{workers}", str(workers)), "distributor"] if workers else []
    running = f" {operator} ".join(draw(st.permutations(parts)))
    return (
        "\n\n".join(
            [
                "enum Mode { idle, run }\n\nexception Overheated",
                PARAMETERS,
                LAW,
                CELLS,
                *definitions,
                f"process Top {{\n    in level : double @ {period}\n    in press : int\n    out drive : double @ "
                f"{period}\n"
                f"    communication {{\n{instances}\n{arrows}\n    }}\n    composition {{\n        {running}\n    "
                f"}}\n}}",
                "submodel Plant(decay: double) {\n    in force : double\n    out level : double\n    out press : int\n"
                "    state x : double = 1.0\n    state count : int = 0\n"
                "    der x = force - decay * x\n    next count = count + 1\n    level = x\n    press = count / 7\n}",
                "environment Bench for Top step 1 ms {\n    plant : Plant(decay = followed * 0.25)\n"
                "    drive -> plant.force\n"
                "    plant.level -> level\n    plant.press -> press\n}",
            ]
        )
        + "\n"
    )
