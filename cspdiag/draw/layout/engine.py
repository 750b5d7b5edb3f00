"""Runs the layout engine, ELK's layered algorithm as JavaScript, in QuickJS or else in node, or by a given function.

The engine is elkjs, ELK (Eclipse Layout Kernel) compiled to JavaScript; see Schulze, Spönemann, von Hanxleden, "Drawing
layered graphs with port constraints", JVLC 25 (2014). It is deterministic: the same graph gets the same layout.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from concurrent.futures import Future
from functools import cache
from importlib.util import find_spec
from queue import SimpleQueue
from typing import Any

from cspdiag.base.files import resources
from cspdiag.draw.layout.graph import LayoutError
from cspdiag.draw.missing import missing

_STACK = 256 * 1024 * 1024
"""Bytes of stack for the engine; recursion in large graphs is deep. Only what is used takes memory."""

_LARGE = 100_000
"""The length of a graph as text from which on node lays it out, if it is there: it takes a tenth of a second to start,
and a tenth of the time that QuickJS takes.
"""

_ENVIRONMENT = """
var window = globalThis, self = globalThis, global = globalThis;
var setTimeout = function (job) { Promise.resolve().then(job); return 1; }, setInterval = setTimeout;
var clearTimeout = function () {}, clearInterval = clearTimeout;
var console = { log: function () {}, warn: function () {}, error: function () {} };
var module = { exports: {} }, exports = module.exports;
"""
"""What elkjs expects around it: a worker that receives messages."""

_WORKER = """
var answer = null, worker = new module.exports.Worker();
worker.onmessage = function (message) { answer = message.data; };
worker.postMessage({ id: 0, cmd: "register", algorithms: ["layered"] });
var reply = function () {
  var error = answer.error;
  return JSON.stringify(error ? { error: String(error.message || error) } : answer);
};
"""
"""Errors of elkjs refer to themselves, so only their message can be passed on."""

_NODE = """
const { Worker } = require(process.argv[1]);
const worker = new Worker();
let requested = false;
worker.onmessage = (message) => {
  if (!requested) {
    requested = true;
    const graph = JSON.parse(require("fs").readFileSync(0, "utf8"));
    worker.postMessage({ id: 1, cmd: "layout", graph, layoutOptions: {}, options: {} });
  } else {
    const error = message.data.error;
    process.stdout.write(JSON.stringify(error ? { error: String(error.message || error) } : message.data));
  }
};
worker.postMessage({ id: 0, cmd: "register", algorithms: ["layered"] });
"""


_used: list[Callable[[str], str]] = []
"""What lays out instead, if anything does."""


def use(lay_out: Callable[[str], str]) -> None:
    """From now on lay out by a function from the text of a graph to that of an answer of elkjs, as in a browser."""
    _used[:] = [lay_out]


def run(graph: dict[str, Any]) -> dict[str, Any]:
    """The graph in ELK's JSON format with places. Raises LayoutError, and MissingToolError if nothing can run the
    engine.
    """
    answer: dict[str, Any] = json.loads(_answer(json.dumps(graph)))
    if "error" in answer:
        reason = str(answer["error"]).partition("\n")[0]
        raise LayoutError(f"the layout failed: {reason}")
    placed: dict[str, Any] = answer["data"]
    return placed


def _answer(graph: str) -> str:
    if _used:
        return _used[0](graph)
    runner, script = _runner(), resources.third_party("elkjs", "elk-worker.min.js")
    node = _node() if len(graph) >= _LARGE else None
    if node is not None and script is not None:
        try:
            return _in_node(node, script, graph)
        except (LayoutError, OSError):
            pass  # A node that is too old, or that has too little memory or stack.
    return runner(graph)


def start() -> None:
    """Begin to load the engine, in parallel with other work until the first graph; does nothing without an engine."""
    if available() and not _used:
        _runner()


def available() -> bool:
    """Whether the engine and something to run it are installed."""
    return bool(_used) or (
        resources.third_party("elkjs", "elk-worker.min.js") is not None
        and (find_spec("quickjs") is not None or _node() is not None)
    )


@cache
def _runner() -> Callable[[str], str]:
    script = resources.third_party("elkjs", "elk-worker.min.js")
    if script is None:
        raise missing("the layout engine elkjs")
    if find_spec("quickjs") is not None:
        return _in_quickjs(script)
    node = _node()
    if node is None:
        raise missing("quickjs-ng")
    return lambda graph: _in_node(node, script, graph)


def _in_quickjs(script: str) -> Callable[[str], str]:
    """A function that lays out in a thread of its own: a context belongs to the thread that made it, and needs more
    stack than others.
    """
    worker = _Worker()
    context = worker.submit(lambda: _context(script))
    return lambda graph: str(worker.submit(lambda: _ask(context.result(), graph)).result())


class _Worker:
    """A thread that does one job after the other. It ends with the program even in the middle of a job, so that Ctrl-C
    ends a long layout.
    """

    def __init__(self) -> None:
        self._jobs: SimpleQueue[tuple[Callable[[], Any], Future[Any]]] = SimpleQueue()
        before = threading.stack_size(_STACK)
        try:
            threading.Thread(target=self._work, name="layout", daemon=True).start()
        finally:
            threading.stack_size(before)

    def submit(self, job: Callable[[], Any]) -> Future[Any]:
        """A future for the result or the exception of a job."""
        future: Future[Any] = Future()
        self._jobs.put((job, future))
        return future

    def _work(self) -> None:
        while True:
            job, future = self._jobs.get()
            try:
                future.set_result(job())
            except BaseException as problem:
                future.set_exception(problem)


def _context(script: str) -> Any:
    import quickjs

    context = quickjs.Context()
    context.set_max_stack_size(_STACK // 2)
    context.eval(_ENVIRONMENT)
    with open(script, encoding="utf-8") as file:
        context.eval(file.read())
    context.eval(_WORKER)
    _finish_jobs(context)
    return context


def _ask(context: Any, graph: str) -> str:
    import quickjs

    context.set("question", graph)
    try:
        context.eval(
            'answer = null; worker.postMessage({ id: 1, cmd: "layout", graph: JSON.parse(question), layoutOptions: {}, '
            "options: {} })"
        )
        _finish_jobs(context)
        text = context.eval("reply()")
    except quickjs.JSException as problem:
        raise LayoutError(f"the layout failed: {problem}") from None
    return str(text)


def _finish_jobs(context: Any) -> None:
    while context.execute_pending_job():
        pass


def _node() -> str | None:
    from shutil import which

    return which("node")


def _in_node(node: str, script: str, graph: str) -> str:
    from subprocess import run as run_process

    done = run_process([node, "-e", _NODE, script], input=graph, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if "Error" in line] or ["node ended unexpectedly"]
        raise LayoutError(f"the layout failed: {lines[0]}")
    return done.stdout
