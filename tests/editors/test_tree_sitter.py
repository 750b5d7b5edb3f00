"""The tree-sitter grammar: its trees are those of the compiler's grammar, its queries find what they are for."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest
import tree_sitter
from hypothesis import HealthCheck, given, settings

from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS
from tests.editors.tree_sitter_trees import FOLDER, compiled, compilers_tree, first_difference, tree_of
from tests.literate import all_cases
from tests.properties.programs import programs
from tests.syntax import generate

ROOT = Path(__file__).parents[2]
QUERIES = sorted((FOLDER / "queries").rglob("*.scm"))
EMACS_MODE = ROOT / "editors" / "emacs" / "csp-ts-mode.el"
GENERATED_BY = "0.26"
"""The version of tree-sitter-cli; another one may generate the same parser in another way."""
_CORPUS = re.compile(r"^=+\n([^\n]+)\n=+\n(.*?)^---\n(.*?)(?=^===|\Z)", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def language(tmp_path_factory: pytest.TempPathFactory) -> tree_sitter.Language:
    return compiled(tmp_path_factory.mktemp("grammar"))


@pytest.fixture(scope="module")
def parser(language: tree_sitter.Language) -> tree_sitter.Parser:
    return tree_sitter.Parser(language)


def difference(parser: tree_sitter.Parser, text: str) -> str:
    """Where the trees of tree-sitter and of the compiler differ; empty if they are equal, or the text has errors."""
    expected = compilers_tree(text)
    if expected is None:
        return ""
    root = parser.parse(text.encode()).root_node
    if root.has_error:
        return f"error in {root}"
    # The root of the one has the space before the first token, that of the other has not.
    return first_difference(expected, tree_of(root, text)._replace(start=expected.start, end=expected.end))


def test_trees_of_all_programs_are_those_of_the_compiler(parser: tree_sitter.Parser) -> None:
    folders = ("models", "examples", "benchmarks", "cspdiag", "tests")
    files = [path for folder in folders for path in sorted((ROOT / folder).rglob("*.csp"))]
    texts = {str(path): path.read_text(encoding="utf-8") for path in files}
    texts |= {f"{c.path.name}: {c.title}: {name}": text for c in all_cases() for name, text in c.files.items()}
    for page in [*ROOT.glob("docs/**/*.md"), *ROOT.glob("manual/**/*.md"), ROOT / "README.md"]:
        blocks = re.findall(r"^```csp[^\n]*\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        texts |= {f"{page.name} {number}": text for number, text in enumerate(blocks)}
    assert len(files) > 200
    assert len(texts) > 1000
    found = {name: difference(parser, text) for name, text in texts.items()}
    assert {name: text for name, text in found.items() if text} == {}


def test_trees_of_random_texts_are_those_of_the_compiler(
    parser: tree_sitter.Parser, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(generate, "NAMES", [*generate.NAMES, "s", "ms", *sorted(CONTEXTUAL_KEYWORDS)])
    compared = 0
    for seed in range(200):
        random = Random(seed)
        tokens = generate.program(random)
        text = generate.sprinkled(tokens, random) if seed % 2 else generate.text_of(tokens)
        assert difference(parser, text) == "", f"seed {seed}\n{text}"
        compared += compilers_tree(text) is not None
    assert compared > 150


@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=programs())
def test_trees_of_random_programs_are_those_of_the_compiler(parser: tree_sitter.Parser, text: str) -> None:
    assert compilers_tree(text) is not None
    assert difference(parser, text) == ""


def test_letters_outside_of_ascii_in_comments(parser: tree_sitter.Parser) -> None:
    assert difference(parser, "/* größer als 3 µs → */ const a = 1 // ≤\nconst b = a ^ 2") == ""


@pytest.mark.parametrize("path", sorted((FOLDER / "test" / "corpus").glob("*.txt")), ids=lambda path: path.stem)
def test_corpus(parser: tree_sitter.Parser, path: Path) -> None:
    cases = _CORPUS.findall(path.read_text(encoding="utf-8"))
    assert cases
    for title, text, expected in cases:
        tree = re.sub(r"\b\w+: ", "", str(parser.parse(text.encode()).root_node))
        assert tree == re.sub(r"\s+(?=\))", "", " ".join(expected.split())), title


def definitions(root: tree_sitter.Node) -> list[str]:
    names = [child.child_by_field_name("name") for child in root.children]
    return [name.text.decode() for name in names if name is not None and name.text is not None]


def leaves(node: tree_sitter.Node) -> list[tree_sitter.Node]:
    return [leaf for child in node.children for leaf in leaves(child)] if node.children else [node]


def test_the_other_definitions_survive_a_missing_token(parser: tree_sitter.Parser) -> None:
    text = (ROOT / "models" / "emergency" / "emergency.csp").read_bytes()
    whole = parser.parse(text).root_node
    names = set(definitions(whole))
    lost = []
    for leaf in leaves(whole):
        partial = parser.parse(text[: leaf.start_byte] + text[leaf.end_byte :]).root_node
        lost.append(len(names - set(definitions(partial))))
    # For nearly every token at most the definition that has the mistake.
    assert sum(count > 1 for count in lost) <= len(lost) / 20


def test_a_text_of_anything_has_a_tree(parser: tree_sitter.Parser) -> None:
    for text in (b"", b"\xff\xfe\x00", b"process P {" * 50, b"((((" * 500, b'1e 5 ms 0x12 " /* <', "π → ∥".encode()):
        assert parser.parse(text).root_node.end_byte <= len(text)


@pytest.mark.parametrize("path", QUERIES, ids=lambda path: "-".join(path.relative_to(FOLDER / "queries").parts))
def test_every_pattern_of_a_query_matches_something(language: tree_sitter.Language, path: Path) -> None:
    query = tree_sitter.Query(language, path.read_text(encoding="utf-8"))
    missing = set(range(query.pattern_count))
    for case in sorted((FOLDER / "test" / "corpus").glob("*.txt")):
        for _, text, _ in _CORPUS.findall(case.read_text(encoding="utf-8")):
            tree = tree_sitter.Parser(language).parse(text.encode())
            missing -= {pattern for pattern, _ in tree_sitter.QueryCursor(query).matches(tree.root_node)}
    assert missing == set()


def captures(language: tree_sitter.Language, query: str, text: str) -> list[tuple[str, str]]:
    """The captures of a query in a text: the first name and what it is for, in the order of the text."""
    tree = tree_sitter.Parser(language).parse(text.encode())
    loaded = tree_sitter.Query(language, (FOLDER / "queries" / query).read_text(encoding="utf-8"))
    found: dict[tuple[int, int], tuple[str, str]] = {}
    for _, names in tree_sitter.QueryCursor(loaded).matches(tree.root_node):
        for name, nodes in names.items():
            for node in nodes:
                assert node.text is not None
                found.setdefault((node.start_byte, node.end_byte), (name, node.text.decode()))
    return [found[place] for place in sorted(found)]


def test_highlights(language: tree_sitter.Language) -> None:
    text = "submodel Law(k: double<V>) { out y : Pose @ 1 ms y = limit(k, 2<V>) } // end"
    assert captures(language, "highlights.scm", text) == [
        ("keyword", "submodel"),
        ("type", "Law"),
        ("punctuation.bracket", "("),
        ("variable.parameter", "k"),
        ("punctuation.delimiter", ":"),
        ("type.builtin", "double"),
        ("type", "<V>"),
        ("punctuation.bracket", ")"),
        ("punctuation.bracket", "{"),
        ("keyword", "out"),
        ("variable.member", "y"),
        ("punctuation.delimiter", ":"),
        ("type", "Pose"),
        ("operator", "@"),
        ("number", "1 ms"),
        ("operator", "="),
        ("function.builtin", "limit"),
        ("punctuation.bracket", "("),
        ("punctuation.delimiter", ","),
        ("number", "2"),
        ("type", "<V>"),
        ("punctuation.bracket", ")"),
        ("punctuation.bracket", "}"),
        ("comment", "// end"),
    ]


def test_every_word_of_the_language_is_highlighted(language: tree_sitter.Language) -> None:
    words = set(re.findall(r'"([a-z]+)"', (ROOT / "grammars" / "csp.lark").read_text(encoding="utf-8")))
    named = {"terminates", "schedulable", "skip", "stop", "true", "false"}
    for path in (FOLDER / "queries" / "highlights.scm", EMACS_MODE):
        query = path.read_text(encoding="utf-8")
        assert {word for word in words - named if f'"{word}"' not in query} == set()
        assert {word for word in named if f"({word})" not in query} == set()


def test_mode_of_emacs_names_nodes_of_the_grammar(language: tree_sitter.Language) -> None:
    settings = EMACS_MODE.read_text(encoding="utf-8").partition("treesit-font-lock-rules")[2].partition("(defvar")[0]
    patterns = re.findall(r"^ *[`']?\(*(\([a-z_]+ (?:[a-z]+: )?\(.*?\)) @", settings, re.MULTILINE)
    assert len(patterns) > 20
    for pattern in patterns:
        tree_sitter.Query(language, pattern + ")" * (pattern.count("(") - pattern.count(")")))


def test_folds(language: tree_sitter.Language) -> None:
    text = "process P {\n  communication {\n    a -> b\n  }\n  composition {\n    (\n      P\n    )\n  }\n}\n"
    tree = tree_sitter.Parser(language).parse(text.encode())
    query = tree_sitter.Query(language, (FOLDER / "queries" / "folds.scm").read_text(encoding="utf-8"))
    folds = tree_sitter.QueryCursor(query).captures(tree.root_node)["fold"]
    lines = sorted((node.start_point[0], node.end_point[0]) for node in folds)
    assert lines == [(0, 9), (1, 3), (4, 8), (5, 7)]


def test_tags(language: tree_sitter.Language) -> None:
    text = "process P { communication { law : Law } composition { law } }"
    names = [found for found in captures(language, "tags.scm", text) if found[0] == "name"]
    assert names == [("name", "P"), ("name", "Law")]


def test_parser_is_that_of_the_grammar(tmp_path: Path) -> None:
    command = shutil.which("tree-sitter")
    if command is None:
        pytest.skip("tree-sitter-cli is not installed")
    shown = subprocess.run([command, "--version"], capture_output=True, text=True, check=True).stdout
    if f" {GENERATED_BY}." not in shown:
        pytest.skip(f"parser.c was generated by tree-sitter {GENERATED_BY}, and {shown.strip()} is installed")
    shutil.copy(FOLDER / "grammar.js", tmp_path)
    shutil.copy(FOLDER / "tree-sitter.json", tmp_path)
    subprocess.run([command, "generate", "--abi", "14"], cwd=tmp_path, check=True)
    for name in ("parser.c", "grammar.json", "node-types.json"):
        assert (tmp_path / "src" / name).read_text(encoding="utf-8") == (FOLDER / "src" / name).read_text(
            encoding="utf-8"
        ), f"make grammar generates another {name}"


def test_commands_of_the_page_install_the_grammar(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "editors.md").read_text(encoding="utf-8").partition("## Highlighting")[2]
    commands = "\n".join(re.findall(r"^```sh\n(.*?)^```$", page, re.MULTILINE | re.DOTALL))
    # Optimization takes the time of all other tests here.
    script = "set -e\n" + commands.replace("-O2", "-O0")
    subprocess.run(["sh", "-c", script], cwd=ROOT, env={**os.environ, "HOME": str(tmp_path)}, check=True)
    installed = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    helix = ".config/helix/runtime"
    assert {f".config/nvim/queries/csp/{name}.scm" for name in ("highlights", "folds", "indents")} <= installed
    assert {f"{helix}/grammars/csp.so", f"{helix}/queries/csp/indents.scm", ".config/nvim/parser/csp.so"} <= installed
    assert "@outdent" in (tmp_path / helix / "queries" / "csp" / "indents.scm").read_text(encoding="utf-8")
    assert {".emacs.d/tree-sitter/libtree-sitter-csp.so", ".emacs.d/csp-ts-mode.el"} <= installed
