"""The network as a graph, from Python and as text for other tools."""

from __future__ import annotations

import io
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import lark
import networkx
import pytest

import cspdiag
from cspdiag.base.render.snippet import on_one_line
from cspdiag.draw.exchange.formats import graph_text

ROOT = Path(__file__).parents[2]
JIWY = ROOT / "models/jiwy/jiwy.csp"
MODELS = [
    ROOT / "models" / name for name in ("jiwy/jiwy.csp", "buffer/buffer.csp", "ring/ring.csp", "dining/deadlock.csp")
]
HOSTILE = 'a"b\\n\\"; }] --> <b>&amp; #35; `x` %% {y} | end\n\x1b[31m\x00\udc80é _z_ *w* 1. ~~'


@pytest.fixture
def jiwy() -> networkx.MultiDiGraph:
    return cspdiag.load(JIWY).graph()


@pytest.fixture
def hostile() -> networkx.MultiDiGraph:
    """A graph in which every text would end strings, lines or tags."""
    graph = cspdiag.load(ROOT / "models/buffer/buffer.csp").graph()
    for _, facts in graph.nodes(data=True):
        facts |= {"name": HOSTILE, "file": HOSTILE, "arguments": {HOSTILE: HOSTILE}}
    for *_, facts in graph.edges(data=True):
        facts |= {"name": HOSTILE, "channel": HOSTILE, "type": HOSTILE}
    graph.graph |= {"name": HOSTILE, "source": HOSTILE}
    return graph


def test_nodes_are_instances_ports_and_environments(jiwy: networkx.MultiDiGraph) -> None:
    assert Counter(kind for _, kind in jiwy.nodes(data="kind")) == {
        "process": 11,
        "submodel": 8,
        "port": 7,
        "environment": 3,
        "driver": 1,
    }
    facts = dict(jiwy.nodes["Jiwy.horizontal.alignL.velocity"])
    assert facts.pop("arguments")["dwell"] == "100 ms"
    assert facts == {
        "kind": "submodel",
        "name": "velocity",
        "path": "Jiwy.horizontal.alignL.velocity",
        "parent": "Jiwy.horizontal.alignL",
        "definition": "VelocityController",
        "class_name": "VelocityController",
        "array": None,
        "index": None,
        "file": str(JIWY),
        "line": 29,
    }
    assert jiwy.nodes["Jiwy.control_vertical"]["period"] == 1_000_000
    assert jiwy.nodes["Bench"]["line"] == 162


def test_an_offset_is_reported_where_there_is_one() -> None:
    text = """
        process Main {
          in  x : int @ 10 ms
          out u : int @ 10 ms offset 2 ms
          communication { var v : int = 0 }
          composition { mu (x ? v ; u ! v) }
        }
        """
    graph = cspdiag.parse(text).graph()
    offsets = {name: facts.get("offset") for name, facts in graph.nodes(data=True)}
    assert offsets == {"Main": None, "Main.x": None, "Main.u": 2_000_000}
    ((_, _, facts),) = graph.in_edges("Main.u", data=True)
    assert (facts["period"], facts["offset"]) == (10_000_000, 2_000_000)
    assert "int @ 10 ms offset 2 ms" in graph_text(graph, "dot")


def test_edges_are_channels_from_each_writer_to_each_reader(jiwy: networkx.MultiDiGraph) -> None:
    ((_, _, facts),) = jiwy.out_edges("Jiwy.joystick_vertical", data=True)
    assert facts == {
        "channel": "Jiwy.joystick_vertical",
        "name": "joystick_vertical",
        "kind": "sampled",
        "type": "double",
        "unit": "1",
        "period": 1_000_000,
        "capacity": None,
        "file": str(JIWY),
        "line": 136,
        "source_port": "joystick_vertical",
        "target_port": "setpoint",
    }
    assert {kind for *_, kind in jiwy.in_edges("Bench", data="kind")} == {"latched"}
    assert next(iter(jiwy["Worn"]["Jiwy.joystick_buttons"].values()))["kind"] == "broadcast"
    keys = [key for *_, key in jiwy.edges(keys=True)]
    assert sorted(keys) == list(range(len(keys)))


def test_elements_of_an_array_are_nodes_of_their_own() -> None:
    graph = cspdiag.load(ROOT / "models/dining/deadlock.csp").graph(set={"seats": 3})
    assert [(f["name"], f["array"], f["index"]) for _, f in graph.nodes(data=True)][1:] == [
        (f"{array}[{index}]", array, index) for array in ("philosopher", "fork") for index in range(3)
    ]
    ring = graph.to_undirected().subgraph(set(graph) - {"SymmetricTable"})
    assert networkx.is_connected(ring)
    assert {degree for _, degree in ring.degree()} == {2}


def test_a_channel_has_its_kind_and_capacity(tmp_path: Path) -> None:
    path = tmp_path / "buffered.csp"
    path.write_text(
        "process W { out o : int composition { mu (o ! 1 ; wait 1 ms) } }\n"
        "process R { in i : int communication { var v : int } composition { mu (i ? v) } }\n"
        "process P { communication { w : W r : R w.o -> c : int buffer 3 -> r.i }"
        " composition { w || r } }\n"
    )
    program = cspdiag.load(path)
    assert program.check() == []
    ((source, target, facts),) = program.graph().edges(data=True)
    assert (source, target, facts["kind"], facts["capacity"]) == ("P.w", "P.r", "buffer", 3)
    assert (facts["source_port"], facts["target_port"], facts["line"]) == ("o", "i", 3)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_every_net_of_a_network_is_there(path: Path) -> None:
    program = cspdiag.load(path)
    graph = program.graph()
    inside = {instance.path for instance in program.network.instances}
    edges = Counter(facts["channel"] for source, target, facts in graph.edges(data=True) if inside & {source, target})
    assert edges == {
        net.path: count
        for net in program.network.nets
        if (count := (len(net.writers) + (net.external == "in")) * (len(net.readers) + (net.external == "out")))
    }


def strings(dot: str) -> list[str]:
    """The strings of a text in DOT, parsed by its grammar."""
    grammar = r"""
        start: "digraph" STRING body
        body: "{" (statement ";" | cluster)* "}"
        cluster: "subgraph" NAME body
        statement: NAME attributes | NAME "->" NAME attributes | attribute
        attributes: "[" attribute ("," attribute)* "]"
        attribute: NAME "=" (STRING | NAME | NUMBER)
        STRING: /"(\\.|[^"\\\n])*"/
        NAME: /[a-z_]\w*/i
        NUMBER: /\d+/
        %ignore /\s+/
    """
    tree = lark.Lark(grammar, parser="lalr").parse(dot)
    return [str(token) for token in tree.scan_values(lambda token: token.type == "STRING")]


def shown_by_graphviz(string: str) -> list[str]:
    """The lines of a label."""
    lines = re.sub(r"\\(.)", lambda found: "\0" if found[1] == "n" else found[1], string[1:-1]).split("\0")
    return [line.replace("&amp;", "&") for line in lines]


def test_no_name_terminates_a_dot_string(hostile: networkx.MultiDiGraph) -> None:
    found = [line for string in strings(graph_text(hostile, "dot")) for line in shown_by_graphviz(string)]
    clean = on_one_line(HOSTILE)
    assert found.count(clean) >= 1 + 2 * hostile.number_of_edges()
    assert all(clean in line or len(line) < 20 for line in found)


MERMAID = re.compile(
    r"flowchart LR| *end| *subgraph s\d+\[S\]| *n\d+(\[S\]|\(S\)|\(\[S\]\)|\[\[S\]\])| *n\d+ -->\|S\| n\d+".replace(
        "S", '"(?:[^"#<>`;]|#[0-9]+;|<br/>)*"'
    )
)


@pytest.mark.parametrize("name", ["jiwy", "hostile"])
def test_no_name_terminates_a_mermaid_string(name: str, request: pytest.FixtureRequest) -> None:
    graph = request.getfixturevalue(name)
    lines = graph_text(graph, "mermaid").splitlines()
    assert [line for line in lines if MERMAID.fullmatch(line) is None] == []
    assert sum("-->" in line for line in lines) == graph.number_of_edges()
    shown = [re.sub("#([0-9]+);", lambda found: chr(int(found[1])), line) for line in lines if " -->|" in line]
    name = next(iter(graph.edges(data="name")))[2]
    assert any(f'-->|"{on_one_line(name)}<br/>' in line for line in shown)


@pytest.mark.parametrize("name", ["jiwy", "hostile"])
def test_graphml_is_read_back_as_the_graph(name: str, request: pytest.FixtureRequest) -> None:
    graph = request.getfixturevalue(name)
    text = graph_text(graph, "graphml").encode()
    read = networkx.read_graphml(io.BytesIO(text), edge_key_type=int, force_multigraph=True)

    def plain(facts: dict[str, object]) -> dict[str, object]:
        return {
            key: on_one_line(value) if isinstance(value, str) else value
            for key, value in facts.items()
            if value is not None and key != "arguments"
        }

    assert list(read) == list(graph)
    for path, facts in graph.nodes(data=True):
        assert plain(read.nodes[path]) == plain(facts)
    assert set(read.edges(keys=True)) == set(graph.edges(keys=True))
    for *edge, facts in graph.edges(keys=True, data=True):
        assert plain(read.edges[edge]) == plain(facts)


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize("name", ["jiwy", "hostile"])
def test_graphviz_draws_the_graph(name: str, request: pytest.FixtureRequest) -> None:
    graph = request.getfixturevalue(name)
    drawn = subprocess.run(
        ["dot", "-Tsvg"], input=graph_text(graph, "dot"), capture_output=True, text=True, check=True, timeout=60
    )
    assert drawn.stdout.count('class="edge"') == graph.number_of_edges()
    assert drawn.stderr == ""


def test_a_graph_of_another_format_is_refused(jiwy: networkx.MultiDiGraph) -> None:
    with pytest.raises(ValueError, match="dot, mermaid, graphml, not 'gml'"):
        graph_text(jiwy, "gml")


def test_the_example_of_the_page_is_as_it_says(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs/drawing.md").read_text()
    (example,) = re.findall(r"```python\n(.*?)```\n", page, re.DOTALL)
    exec(example, {})
    expected = [line.partition("# ")[2] for line in example.splitlines() if line.startswith("print(")]
    assert capsys.readouterr().out.splitlines() == expected
