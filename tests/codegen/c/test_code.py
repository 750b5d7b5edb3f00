"""The tree of C: parentheses, negations, bodies that are not empty, and lines that fit."""

from __future__ import annotations

import re
from itertools import product

import pytest

from cspdiag import pipeline
from cspdiag.base.span import SourceFile
from cspdiag.codegen.c.text.code import (
    AND,
    EQUALITY,
    LINE_LENGTH,
    OR,
    PRODUCT,
    RELATION,
    SUM,
    Code,
    address,
    call,
    cast,
    code,
    conditional,
    infix,
    minus,
    negated,
    own,
    target,
)
from cspdiag.codegen.c.text.statements import (
    If,
    Label,
    Remark,
    Statement,
    choose,
    define,
    goto,
    has_effect,
    jumps_to,
    lines,
    mentions_self,
    run,
    store,
)
from tests.codegen.packages import network, read

a, b, c = map(code, "abc")
LESS = infix("<", RELATION, a, b)
SAME = infix("==", EQUALITY, a, b)


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (infix("+", SUM, a, infix("*", PRODUCT, b, c)), "a + b * c"),
        (infix("*", PRODUCT, infix("+", SUM, a, b), c), "(a + b) * c"),
        (infix("-", SUM, a, infix("-", SUM, b, c)), "a - (b - c)"),
        (infix("-", SUM, infix("-", SUM, a, b), c), "a - b - c"),
        (infix("&&", AND, LESS, SAME), "(a < b) && (a == b)"),
        (infix("&&", AND, infix("&&", AND, a, b), LESS), "a && b && (a < b)"),
        (infix("||", OR, infix("&&", AND, a, b), c), "(a && b) || c"),
        (infix("==", EQUALITY, LESS, c), "(a < b) == c"),
        (conditional(LESS, a, conditional(SAME, b, c)), "(a < b) ? a : ((a == b) ? b : c)"),
        (conditional(a, infix("+", SUM, a, b), c), "a ? a + b : c"),
        (cast("int8_t", infix("+", SUM, a, b)), "(int8_t)(a + b)"),
        (cast("int8_t", cast("int8_t", a)), "(int8_t)a"),
        (minus(minus(a)), "-(-a)"),
        (minus(infix("*", PRODUCT, a, b)), "-(a * b)"),
        (target(address(a)), "a"),
        (address(target(a)), "a"),
        (target(a).field("x"), "(*a).x"),
        (call("f", own(code("x")).field("y").at(3), address(own("z"))), "f(self->x.y[3], &self->z)"),
    ],
)
def test_parentheses_stand_where_they_are_wanted(tree: Code, text: str) -> None:
    assert str(tree) == text


@pytest.mark.parametrize(
    ("condition", "opposite"),
    [
        (SAME, "a != b"),
        (infix("!=", EQUALITY, a, b), "a == b"),
        (a, "!a"),
        (negated(a), "a"),
        (negated(LESS), "a < b"),
        (LESS, "!(a < b)"),
        (infix("||", OR, a, b), "!(a || b)"),
        (code("true"), "false"),
    ],
)
def test_the_opposite_of_a_condition(condition: Code, opposite: str) -> None:
    assert str(negated(condition)) == opposite


def test_no_branch_is_empty() -> None:
    remark, done = Remark("nothing to do"), store(a, b)
    assert choose(SAME, [remark], [done]) == [If(negated(SAME), (done,))]
    assert choose(SAME, [done], [remark]) == [If(SAME, (done,))]
    assert choose(SAME, [remark], []) == [remark]
    assert lines(choose(SAME, [done], choose(LESS, [done], [run("stop()")]))) == [
        "if (a == b) {",
        "    a = b;",
        "} else if (a < b) {",
        "    a = b;",
        "} else {",
        "    stop();",
        "}",
    ]


def test_no_comment_is_repeated() -> None:
    assert lines([Remark("x := 1"), Remark("x := 1"), run("stop()")]) == ["/* x := 1 */", "stop();"]


@pytest.mark.parametrize(
    ("following", "label"),
    [
        ([run("stop()")], "here:"),
        ([Remark("then"), run("stop()")], "here:"),
        ([define("int", "x", "0")], "here:;"),
        ([], "here:;"),
    ],
)
def test_a_label_is_followed_by_a_statement(following: list[Statement], label: str) -> None:
    assert lines([Label("here"), *following], 1)[0] == label


def test_questions_are_answered_by_the_tree() -> None:
    inside = choose(SAME, [goto("fails")])
    assert jumps_to("fails", inside)
    assert jumps_to("fails", [run(call("CSP_AWAIT", "first", "again", "PLACE", "fails"), "")])
    assert not jumps_to("fail", inside)
    assert mentions_self(choose(LESS, [store(own("x"), a)]))
    assert not mentions_self([store("self->x", a)])
    assert not has_effect([Remark("a = b;")])


MODELS = ("jiwy", "cascade", "dining", "emergency", "watchdog", "buffer")


@pytest.mark.parametrize(("name", "level"), [*product(MODELS, (0, 1))])
def test_a_reviewer_finds_none_of_these(name: str, level: int) -> None:
    """Finds long lines, empty bodies, comparisons in the wrong direction, comma operators, addresses of dereferenced
    pointers, double parentheses, results that are not looked at, and what is said or tested twice.
    """
    package = pipeline.generate(network(name), read, "c", level)
    objections = {
        "empty body": r"\{\s*(/\*([^*]|\*[^/])*\*/\s*)*\}",
        "negated comparison": r"!\((?!.*(&&|\|\|))[^()]* (==|!=) [^()]*\)",
        "pointer to what is pointed to": r"&\*|\*&",
        "comma that evaluates": r"\((csp_require_written|csp_operand_\d+ =)",
        "needless parentheses": r"!\((\w|->|\.)+\)|\(\((\w|->|\.)+\)\)",
        "jump to the next statement": r"goto (\w+);\s*\1:",
        "zero that is added": r"\+ -?0\.0f?\b",
        "comment that is repeated": r"( */\*.*\*/\n)\1",
        "ignored result of a law": r"\(void\)\w+_calculate\(",
        "return at the end": r"return;\n\s*}\n}",
        "value that has been tested": r"csp_finite\(csp, self->\w*(law|servo|velocity)(\.|_)control,",
        "test of a literal": r"(finite\w*|csp_real\w*)\((csp, )?-?[\d.]+[,)]",
        "end that is named after a number": r"self->\w*feedback_\d",
    }
    for path, text in package.items():
        if path.startswith("support/") or not path.endswith((".c", ".h")):
            continue
        assert max(map(len, text.splitlines())) <= LINE_LENGTH, path
        for objection, pattern in objections.items():
            found = re.search(pattern, text)
            assert found is None, f"{path}: {objection}: {found[0]}"


LONGEST = 120


@pytest.mark.parametrize(("name", "level"), [*product((*MODELS, "ring", "commstime"), (0, 1))])
def test_no_function_is_long(name: str, level: int) -> None:
    for path, text in pipeline.generate(network(name), read, "c", level).items():
        if not path.startswith("support/") and path.endswith(".c"):
            lengths = [body.count("\n") for body in re.findall(r"^\{\n.*?^\}$", text, re.MULTILINE | re.DOTALL)]
            assert max(lengths, default=0) <= LONGEST, path


def test_inlined_processes_of_a_long_function_have_functions_of_their_own() -> None:
    text = pipeline.generate(network("jiwy"), read, "c", 1)["joint_control.c"]
    functions = re.findall(r"^static csp_party \*joint_control_(\w+)\(", text, re.MULTILINE)
    assert functions[-6:] == ["fails", "align_l", "align_r", "motion_control", "homing", "step"]


def test_steps_of_a_long_function_that_differ_in_numbers_are_a_table() -> None:
    text = pipeline.generate(network("dining"), read, "c", 1)["table.c"]
    assert "{4U, 3}, /* right ? holder (table.csp:17) */" in text
    assert text.count("self->fork_holder[table_steps[i].element] = table_steps[i].value;") == 1
    assert text.count("table_takes_steps(csp, party, ") == 11


def test_steps_of_a_long_function_whose_numbers_count_are_a_loop() -> None:
    text = pipeline.generate(network("ring"), read, "c", 1)["ring.c"]
    assert "const int64_t csp_result = csp_add(csp, self->cell_output_offered[i], 1);" in text


def test_one_macro_contains_jumps() -> None:
    """Those of `csp_leaf.h` for processes by hand consist of it."""
    macros = [
        macro
        for path, text in pipeline.generate(network("jiwy"), read, "c", 0).items()
        if path.endswith(".h")
        for macro in re.findall(r"^#define (\w+)\((?:[^\n]*\\\n)*[^\n]*\b(?:return|goto|case)\b", text, re.MULTILINE)
    ]
    assert macros == ["CSP_AWAIT"]


def test_literals_have_no_casts() -> None:
    """Next to a value of 64 bits, and converted themselves."""
    text = """
const STEP : uint16 = 1

process Counter {
  in  tick  : int @ 10 ms
  out total : int @ 10 ms

  communication {
    var given : int = 0
    var short : uint16 = 3
    var long : uint32 = 3
  }

  composition {
    mu (tick ? given ; short := (short + 1) % 5 ; long := 7 - long * 2 ; short := short + STEP ;
        total ! int(short) + int(uint16(1)) + given)
  }
}
"""
    checked = pipeline.build(SourceFile(name="counter.csp", text=text), read).network
    assert checked is not None
    counter = pipeline.generate(checked, read, "c", 0)["counter.c"]
    assert re.findall(r"\(u?int\d+_t\)-?\d", counter) == []
    assert "(int64_t)self->short_ + (int64_t)STEP" in counter
    assert "csp_uint32(csp, 7 - (int64_t)csp_uint32(csp, (int64_t)self->long_ * 2))" in " ".join(counter.split())
    assert "csp_add(csp, csp_add(csp, (int64_t)self->short_, 1), self->given)" in " ".join(counter.split())


def test_a_zero_is_added_in_single_precision() -> None:
    built = pipeline.build(read("models/jiwy/jiwy.csp"), read, real="float32")
    assert built.network is not None
    text = pipeline.generate(built.network, read, "c", 1)["joint_control.c"]
    assert "csp_positive_zero_single(" in text
    assert "csp_positive_zero(" not in text


@pytest.mark.parametrize(("name", "level"), [*product(MODELS, (0, 1))])
def test_what_a_file_includes_and_what_types_define_is_used(name: str, level: int) -> None:
    package = pipeline.generate(network(name), read, "c", level)
    own = {path: text for path, text in package.items() if "/" not in path and path.endswith((".c", ".h"))}
    constants = set(re.findall(r"^static const .*?(\w+)(?: =|$)", own["constants.h"], re.MULTILINE))
    for path, text in own.items():
        words = set(re.findall(r"\w+", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)))
        if '#include "constants.h"' in text:
            assert constants & words, path
        if '#include "csp_arithmetic.h"' in text:
            assert any(word.startswith(("csp_", "CSP_")) for word in words - {"csp_arithmetic"}), path
    program = "\n".join(own.values())
    for function in re.findall(r"^static inline \w+ (\w+_(?:equal|finite))\(", own["types.h"], re.MULTILINE):
        assert program.count(f"{function}(") > 1, function
    assert "position < 1;" not in own["types.h"]
