"""What runs the layout engine, and what is reported if nothing can."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from importlib.util import find_spec

import pytest

from cspdiag.base.files import resources
from cspdiag.cli.main import main
from cspdiag.draw.layout import engine
from cspdiag.draw.layout.elk import engine_available, lay_out
from cspdiag.draw.layout.graph import Edge, Graph, LayoutError, Node
from cspdiag.draw.missing import MissingToolError

needs_engine = pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")

GRAPH = Graph((Node("a", 40, 20), Node("b", 40, 20)), (Edge("e", ("a",), ("b",)),))
MODEL = "models/commstime/commstime.csp"


@pytest.fixture(autouse=True)
def fresh_engine() -> Iterator[None]:
    """Each test determines anew what is installed."""
    engine._runner.cache_clear()
    yield
    engine._runner.cache_clear()


def without_quickjs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "find_spec", lambda _: None)


@needs_engine
@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_node_lays_out_as_quickjs_does(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = lay_out(GRAPH)
    engine._runner.cache_clear()
    without_quickjs(monkeypatch)
    assert lay_out(GRAPH) == expected


@needs_engine
@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_large_graphs_are_laid_out_by_node(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = lay_out(GRAPH)
    asked: list[str] = []
    in_node = engine._in_node

    def asking(node: str, script: str, graph: str) -> str:
        asked.append(node)
        return in_node(node, script, graph)

    monkeypatch.setattr(engine, "_in_node", asking)
    monkeypatch.setattr(engine, "_LARGE", 10)
    assert lay_out(GRAPH) == expected
    assert asked


@needs_engine
@pytest.mark.skipif(find_spec("quickjs") is None, reason="quickjs-ng is not installed")
def test_a_node_that_fails_is_not_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = lay_out(GRAPH)
    monkeypatch.setattr(engine, "_LARGE", 10)
    monkeypatch.setattr(engine, "_node", lambda: "false")
    assert lay_out(GRAPH) == expected


@needs_engine
def test_without_anything_to_run_it_the_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    without_quickjs(monkeypatch)
    monkeypatch.setattr(engine, "_node", lambda: None)
    assert not engine_available()
    with pytest.raises(MissingToolError, match=r"pip install 'cspdiag\[draw\]'"):
        lay_out(GRAPH)


def test_without_elkjs_a_checkout_says_what_fetches_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(resources, "third_party", lambda *_: None)
    assert not engine_available()
    assert main(["draw", MODEL, "-o", "-"]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert (
        shown.err == "cspdiag: the layout engine elkjs is not there: in a checkout `make setup` fetches it with npm\n"
    )


@needs_engine
def test_errors_of_the_engine_are_one_line() -> None:
    wrong = {"id": "", "children": [{"id": "a"}], "edges": [{"id": "e", "sources": ["a"], "targets": ["nowhere"]}]}
    with pytest.raises(LayoutError) as caught:
        engine.run(wrong)
    assert str(caught.value).startswith("the layout failed: ")
    assert "nowhere" in str(caught.value)
    assert "\n" not in str(caught.value)


@needs_engine
def test_the_engine_works_after_a_failure() -> None:
    expected = lay_out(GRAPH)
    with pytest.raises(LayoutError):
        engine.run({"id": "", "edges": [{"id": "e", "sources": ["x"], "targets": ["y"]}]})
    assert lay_out(GRAPH) == expected


@needs_engine
def test_boxes_in_boxes_need_no_stack_of_the_caller() -> None:
    node = Node("0", 20, 20)
    for depth in range(1, 40):
        node = Node(str(depth), children=(node,))
    layout = lay_out(Graph((node,)))
    assert layout.nodes["39"].contains(layout.nodes["0"])
