"""What name resolution leaves to later passes: types of all expressions, bindings and members."""

from __future__ import annotations

from cspdiag.model.program import BuiltinSymbol, EnumLiteralSymbol, PortSymbol, Program
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes
from tests.model.programs import correct, resolved

LAW = """
enum Mode { idle, run }

submodel Gain(k: double) {
  in  x : double
  out y : double
  y = k * x
}

submodel Law(tau: time, gains: double[2], mode: Mode = Mode.run) {
  in  error  : double<rad>
  out output : double<V>
  state sum : double<rad> = 0
  gain : Gain(k = 2 * gains[1])
  let rate = (error - pre(error, 0)) / sample
  gain.x = sum + 3 * rate * tau
  output = if mode == Mode.run then gain.y * 1<V> else 0
  next sum = lag(error, tau * 2, method = zoh)
}

process Main(T: time = 1 ms) {
  in  angle   : double<rad> @ T
  out voltage : double<V>   @ T
  communication {
    law : Law(10 ms, [1, 2])
    var n : int = 0
    angle      -> law.error
    law.output -> voltage
  }
  composition { (mu (law ; n := n + 1 ; wait 2 * T) until n > 10) catch Fault -> voltage ! 0 }
}
"""


def expressions(program: Program) -> list[ast.Node]:
    kinds = (
        ast.Number
        | ast.Duration
        | ast.Name
        | ast.Member
        | ast.Index
        | ast.Unary
        | ast.Binary
        | ast.Call
        | ast.ArrayValue
    )
    return [part for part in nodes(program.main) if isinstance(part, kinds)]


def type_of(program: Program, text: str, at: int = 0) -> str:
    found = [part for part in expressions(program) if part.span.text == text]
    return str(program.types[found[at]])


def test_every_expression_has_a_type() -> None:
    program = correct(LAW)
    untyped = {part.span.text for part in expressions(program) if part not in program.types}
    # The name of an enum before a literal and of an instance before a port, and the value of an option, are not values.
    assert untyped == {"Mode", "gain", "zoh"}


def test_numbers_in_the_text_take_the_type_of_their_surroundings() -> None:
    program = correct(LAW)
    assert type_of(program, "2 * gains[1]") == "double"
    assert type_of(program, "2", at=1) == "double"
    assert type_of(program, "[1, 2]") == "double[2]"
    assert type_of(program, "1", at=1) == "double"
    assert type_of(program, "10") == "int"
    assert [str(program.types[part]) for part in expressions(program) if part.span.text == "0"] == [
        "double<rad>",
        "double<rad>",
        "double<V>",
        "int",
        "double<V>",
    ]


def test_a_time_is_a_number_of_seconds_in_equations_only() -> None:
    program = correct(LAW)
    assert type_of(program, "tau") == "double<s>"
    assert type_of(program, "sample") == "double<s>"
    assert type_of(program, "10 ms") == "time"
    assert type_of(program, "2 * T") == "time"
    assert type_of(program, "3 * rate * tau") == "double<rad>"


def test_names_are_bound_to_what_they_mean() -> None:
    program = correct(LAW)
    meanings = {
        part.span.text: program.bindings[part]
        for part in expressions(program)
        if isinstance(part, ast.Name) and part in program.bindings
    }
    assert isinstance(meanings["tau"], ast.Parameter)
    assert isinstance(meanings["error"], PortSymbol)
    assert isinstance(meanings["sum"], ast.State)
    assert isinstance(meanings["rate"], ast.Let)
    assert isinstance(meanings["n"], ast.Variable)
    assert isinstance(meanings["sample"], BuiltinSymbol)
    members = {part.span.text: found for part, found in program.members.items()}
    assert isinstance(members["Mode.run"], EnumLiteralSymbol)
    assert members["Mode.run"].index == 1
    port = members["gain.y"]
    assert isinstance(port, PortSymbol)
    assert port.name == "y"


def test_ports_and_names_of_a_definition() -> None:
    program = correct(LAW)
    main = program.scopes[program.definitions["Main"]]
    assert list(main.ports) == ["angle", "voltage"]
    assert list(main.names) == ["T", "angle", "voltage", "law", "n"]


def test_uses_of_time_are_known_by_submodel() -> None:
    program = correct(
        "submodel Wave { out y : double  y = sin(time * 1<rad/s>) }\nsubmodel Flat { out y : double  y = 1 }\n"
    )
    assert [owner.span.text[:13] for owner in program.time_uses] == ["submodel Wave"]


def test_later_passes_know_what_was_reported() -> None:
    program, report = resolved(
        """
        process Main {
          communication { law : Missing }
          composition { law }
        }
        """
    )
    assert [found.code for found in report.diagnostics] == ["E0204"]
    assert [type(part).__name__ for part in program.poisoned].count("Instance") == 1


def test_instances_that_close_a_circle_are_poisoned() -> None:
    program, _ = resolved(
        """
        process Ping { communication { pong : Pong } composition { pong } }
        process Pong { communication { ping : Ping } composition { ping } }
        """
    )
    instances = [part for part in nodes(program.main) if isinstance(part, ast.Instance)]
    assert set(instances) <= program.poisoned
