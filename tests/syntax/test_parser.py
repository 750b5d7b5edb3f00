"""The parser: trees, places, recovery, and an answer to any input."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.base import Report, SourceFile
from cspdiag.syntax import ast
from cspdiag.syntax.parser import parse
from tests.syntax.generate import program, text_of

SEEDS = st.integers(0, 2**40).map(Random)


def parsed(text: str) -> tuple[ast.SourceTree, list[str]]:
    report = Report()
    tree = parse(SourceFile(name="case.csp", text=text), report)
    return tree, [diagnostic.code for diagnostic in report.diagnostics]


def definition(text: str) -> ast.Item:
    tree, codes = parsed(text)
    assert codes == []
    (item,) = tree.items
    return item


def composition(text: str) -> ast.Composition:
    process = definition(f"process P {{ composition {{ {text} }} }}")
    assert isinstance(process, ast.ProcessDefinition)
    assert process.composition is not None
    return process.composition


def expression(text: str) -> ast.Expression:
    constant = definition(f"const X = {text}")
    assert isinstance(constant, ast.Constant)
    return constant.value


def shape(node: object) -> object:
    """An expression as nested tuples."""
    match node:
        case ast.Binary(operator=operator, left=left, right=right):
            return shape(left), operator, shape(right)
        case ast.Unary(operator=operator, operand=operand):
            return operator, shape(operand)
        case ast.Name(name=name):
            return name
        case ast.Number(value=value):
            return value
    raise AssertionError(node)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b * c", ("a", "+", ("b", "*", "c"))),
        ("a - b - c", (("a", "-", "b"), "-", "c")),
        ("-x^2", ("-", ("x", "^", 2))),
        ("2^-x", (2, "^", ("-", "x"))),
        ("x^y^z", ("x", "^", ("y", "^", "z"))),
        ("not a == b and c or d", ((("not", ("a", "==", "b")), "and", "c"), "or", "d")),
        ("a < b + 1", ("a", "<", ("b", "+", 1))),
        ("-a * b", (("-", "a"), "*", "b")),
    ],
)
def test_precedence_of_expressions(text: str, expected: object) -> None:
    assert shape(expression(text)) == expected


def test_prefix_forms_take_the_next_operand_only() -> None:
    chain = composition("mu a until stop ; b")
    assert isinstance(chain, ast.Sequence)
    assert [type(process) for process in chain.processes] == [ast.Mu, ast.Run]
    guarded = composition("a ? x -> b ; c")
    assert isinstance(guarded, ast.Sequence)
    assert [type(process) for process in guarded.processes] == [ast.Guarded, ast.Run]


def test_catch_binds_more_tightly_than_mu() -> None:
    loop = composition("mu a catch Timeout -> b")
    assert isinstance(loop, ast.Mu)
    assert isinstance(loop.process, ast.Catch)


def test_else_belongs_to_the_nearest_if() -> None:
    outer = composition("if a then if b then c else d")
    assert isinstance(outer, ast.If)
    assert outer.otherwise is None
    assert isinstance(outer.then, ast.If)
    assert outer.then.otherwise is not None


def test_stop_is_a_process_alone_and_a_name_elsewhere() -> None:
    chain = composition("stop ; stop ! 1 ; stop := 2 ; (stop ? x -> stop)")
    assert isinstance(chain, ast.Sequence)
    assert [type(process) for process in chain.processes] == [ast.Stop, ast.Write, ast.Assign, ast.Guarded]


def test_chains_are_flat_however_long() -> None:
    chain = composition(" ; ".join(["skip"] * 20_000))
    assert isinstance(chain, ast.Sequence)
    assert len(chain.processes) == 20_000


@pytest.mark.parametrize(
    ("text", "nanoseconds"),
    [("1 ms", 1_000_000), ("250us", 250_000), ("0.1 s", 100_000_000), ("1 kHz", 1_000_000), ("3 Hz", 333_333_333)],
)
def test_durations_are_exact(text: str, nanoseconds: int) -> None:
    duration = expression(text)
    assert isinstance(duration, ast.Duration)
    assert duration.nanoseconds == nanoseconds


def test_an_integer_is_one_without_point_exponent_or_unit() -> None:
    values = [expression(text) for text in ("12", "12.0", "1e3", "12<V>")]
    assert [type(value.value) for value in values if isinstance(value, ast.Number)] == [int, float, float, float]


def test_doc_comments_go_to_what_follows() -> None:
    text = (
        "/// First\n/// and second.\nprocess P {\n  /// The angle.\n  in x : int\n  communication {\n    /// Counts.\n "
        "   var n : int\n  }\n}\n"
    )
    process = definition(text)
    assert isinstance(process, ast.ProcessDefinition)
    assert process.doc == "First\nand second."
    assert process.ports[0].doc == "The angle."
    assert process.communication is not None
    (variable,) = process.communication.declarations
    assert isinstance(variable, ast.Variable)
    assert variable.doc == "Counts."


def test_a_doc_comment_of_nothing_is_a_comment() -> None:
    tree, codes = parsed("const A = 1\n/// left over\n")
    assert codes == []
    assert [comment.text for comment in tree.comments] == ["/// left over"]


def test_spans_are_exact() -> None:
    process = definition("process P {\n  in a, b : double<rad> @ T\n  composition { a ? x ; (b ! 1 + 2) }\n}")
    assert isinstance(process, ast.ProcessDefinition)
    (port,) = process.ports
    assert port.span.text == "in a, b : double<rad> @ T"
    assert port.type.span.text == "double<rad>"
    assert port.type.unit_span is not None
    assert port.type.unit_span.text == "<rad>"
    assert process.composition_span is not None
    assert process.composition_span.text == "composition { a ? x ; (b ! 1 + 2) }"
    assert isinstance(process.composition, ast.Sequence)
    assert [step.span.text for step in process.composition.processes] == ["a ? x", "(b ! 1 + 2)"]
    assert (process.composition.span.line, process.composition.span.column) == (3, 17)


def test_an_array_of_instances_may_count() -> None:
    process = definition("process P { communication { cell[i < 8] : Cell(id = i)  other[4] : Cell } }")
    assert isinstance(process, ast.ProcessDefinition)
    assert process.communication is not None
    counted, plain = process.communication.declarations
    assert isinstance(counted, ast.Instance)
    assert isinstance(counted.size, ast.Replicator)
    assert isinstance(plain, ast.Instance)
    assert isinstance(plain.size, ast.Number)


def test_intact_definitions_survive_broken_ones() -> None:
    tree, codes = parsed("const A = \nconst B = 2\nprocess P {\n  in x double\n  in y : int\n}\n")
    assert codes == ["E0101", "E0101"]
    names = [item.name.text for item in tree.items if not isinstance(item, ast.Import | ast.Assertion)]
    assert names == ["B", "P"]
    process = tree.items[-1]
    assert isinstance(process, ast.ProcessDefinition)
    assert [port.names[0].name.text for port in process.ports] == ["y"]


@pytest.mark.parametrize(
    "text",
    [
        "const A = " + "(" * 10_000 + "1" + ")" * 10_000,
        "const A = " + "(" * 10_000,
        "const A = " + "-" * 10_000 + "1",
        "const A = 1" + " + 1" * 10_000,
        "const A = a" + "[0]" * 10_000,
        "const A = a" + ".b" * 10_000,
        "const A = " + "[" * 10_000,
        "const A = " + "f(" * 10_000,
        "const A = " + "if a then " * 10_000,
        "process P { composition { " + "(" * 10_000 + "skip" + ")" * 10_000 + " } }",
        "process P { composition { " + "a : " * 10_000 + "skip } }",
        "process P { composition { " + "if a then " * 10_000 + "skip } }",
        "process P { composition { skip" + " catch T -> skip" * 10_000 + " } }",
        "process P { communication { " + "for i < 2 { " * 10_000 + "} } ",
    ],
)
def test_deep_nesting_is_refused(text: str) -> None:
    assert parsed(text)[1] == ["E0103"]


def test_a_name_after_a_number_need_not_look_like_a_unit() -> None:
    assert parsed("const A = 5 _b")[1] == ["E0101"]


def test_nesting_up_to_the_limit_is_read() -> None:
    assert parsed("const A = " + "(" * 200 + "1" + ")" * 200)[1] == []
    assert parsed("const A = " + "(" * 201 + "1" + ")" * 201)[1] == ["E0103"]


@settings(max_examples=300, deadline=None)
@given(st.text())
def test_any_text_gets_an_answer(text: str) -> None:
    parsed(text)


@settings(max_examples=300, deadline=None)
@given(SEEDS, st.data())
def test_damage_gives_diagnostics_with_places(random: Random, data: st.DataObject) -> None:
    tokens = program(random, definitions=3)
    for _ in range(data.draw(st.integers(1, 3))):
        at = random.randrange(len(tokens) + 1)
        if random.random() < 0.5:
            del tokens[at : at + random.randint(1, 4)]
        else:
            tokens.insert(
                at, random.choice(["(", ")", "{", "}", "->", ";", "in", "=", "process", "$", '"', "||", "mu", "@"])
            )
    text = text_of(tokens)
    report = Report()
    parse(SourceFile(name="case.csp", text=text), report)
    for diagnostic in report.diagnostics:
        assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text)
        assert diagnostic.message
        assert "__" not in diagnostic.message
        assert "None" not in str(diagnostic.help or "")
