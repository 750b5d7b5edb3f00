"""A program with numbered lines, enough of them that generated code keeps them as arrays."""

from __future__ import annotations

from cspdiag.codegen.shared.places_in_arrays import MANY

COUNT = MANY + 1

_PROCESSES = """
exception Finished

process Cell(id : int) {
  in  input  : int
  out output : int
  communication { var value : int }
  composition { mu (input ? value ; output ! value * 3 % 1000 + id) }
}

process Head(rounds : int) {
  in  input  : int
  out output : int
  communication { var value : int = 1  var turns : int = 0 }
  composition { (mu (output ! value ; input ? value ; turns := turns + 1) until turns == rounds) ; raise Finished }
}

process Listener(id : int) {
  in  news : int
  out seen : int
  communication { var value : int }
  composition { news ? value ; seen ! value + id }
}

process Speaker { out news : int  composition { news ! 7 } }

process Sink { in input : int  communication { var value : int }  composition { input ? value } }

process Collector {
  in seen[COUNT] : int
  communication { var sum : int = 0  var value : int }
  composition { seq i < COUNT : (seen[i] ? value ; sum := sum + value) }
}
"""


def program() -> str:
    """A ring of cells, of which one has another argument and one another name (``cell007``); listeners to a broadcast,
    between two of which others are made; and variables, each computed from the one before.
    """
    every = range(COUNT)
    cells = [*(f"cell{i}" for i in every), "cell007"]
    listeners = [f"listener{i}" for i in every]
    declared = [
        *(f"var x{i} : int" for i in every),
        "head : Head(rounds = 2)",
        *(f"{cell} : Cell(id = {0 if i == 60 else i})" for i, cell in enumerate(cells)),
        *(f"{one}.output -> {other}.input" for one, other in zip(["head", *cells], [*cells, "head"], strict=True)),
        *("speaker : Speaker", "collector : Collector"),
        *(f"{listener} : Listener(id = {i})" for i, listener in enumerate(listeners[:50])),
        *("between : Listener(id = 5)", "last : Sink"),
        *(f"{listener} : Listener(id = {i})" for i, listener in enumerate(listeners[50:], 50)),
        f"speaker.news -> broadcast -> between.news, {', '.join(f'{listener}.news' for listener in listeners)}",
        "between.seen -> last.input",
        *(f"{listener}.seen -> collector.seen[{i}]" for i, listener in enumerate(listeners)),
    ]
    assigned = " ; ".join(f"x{i} := {f'x{i - 1} + {i}' if i else 1}" for i in every)
    listening = " || ".join(["speaker", "collector", "between", "last", *listeners])
    composed = f"({assigned}) ; ({listening}) ; (({' || '.join(['head', *cells])}) catch Finished -> skip)"
    lines = "\n    ".join(declared)
    main = f"process Main {{\n  communication {{\n    {lines}\n  }}\n  composition {{\n    {composed}\n  }}\n}}\n"
    return _PROCESSES.replace("COUNT", str(COUNT)) + main
