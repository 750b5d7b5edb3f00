"""Programs that become one process, programs that must not, and that both behave as before."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, note, settings

from cspdiag.base import SourceFile
from cspdiag.network.dump.network import dump
from cspdiag.network.ir.actions import AssignValue, ReadValue, Repeat, ReportCommunication, RunInstance
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize import PASSES, optimize
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.program import explain_fusion, fuse, fused
from cspdiag.semantics.execute import execute
from tests.conformance.sources import JUST_AFTER, environments, network_of, read
from tests.conformance.traces import compare
from tests.optimize.static_networks import static_networks

BEFORE = tuple(entry for entry in PASSES if entry.name != "fuse")


def assert_same(network: Network, other: Network, until: int) -> None:
    """Both networks have equal traces, in every environment."""
    external = {f"{network.top}.{port.name}" for port in network.external_ports}
    for environment in environments(network):
        one, two = (execute(n, environment, until + JUST_AFTER) for n in (network, other))
        difference = compare(one.trace, two.trace, external)
        assert difference is None, f"left: before, right: after\n{difference}\n{dump(other)}"
        assert one.ending == two.ending


def program(processes: str, channels: str, running: str, ports: str = "", environment: str = "") -> str:
    """A program with the outermost process ``Top``."""
    return f"""exception Enough

{processes}

process Top {{
{ports}
  communication {{
{channels}
  }}
  composition {{ {running} }}
}}
{environment}
"""


PLANT = """
submodel Plant {
  in  u : double = 0
  out x, y : double
  out press : int

  state s : double = 1
  state k : int = 0
  der s = u - s
  next k = k + 1
  x = s
  y = 2 * s
  press = k / 3
}
"""

SENDER = """process Sender {
  out o : int
  communication { var n : int = 0 }
  composition { mu (o ! n ; n := n + 1 ; wait 1 ms) }
}
"""

RECEIVER = """process Receiver {
  in i : int
  communication { var v : int }
  composition { mu i ? v }
}
"""

PAIR = "    s : Sender\n    r : Receiver\n    s.o -> c : int -> r.i"


@pytest.mark.parametrize("name", ["commstime", "ring", "cascade", "dining"])
def test_model_is_one_process(name: str) -> None:
    network = network_of(read(f"models/{name}/{name}.csp"))
    after = optimize(network)
    assert [entry.name for entry in after.classes] == [network.top]
    assert [instance.path for instance in after.instances] == [network.top]
    assert_same(network, after, 300_000_000)


def test_channels_stay_in_the_trace() -> None:
    network = optimize(network_of(read("models/commstime/commstime.csp")))
    (top,) = network.classes
    assert isinstance(top, ProcessClass)
    assert {part.channel for part in parts(top.body) if isinstance(part, ReportCommunication)} == {"a", "b", "c", "d"}
    assert not top.instances
    assert not any(isinstance(part, RunInstance) for part in parts(top.body))
    assert all(channel.kind == "var" for channel in top.channels)


REFUSED = {
    "event": (
        program(
            "process Button {\n  in press : int\n  out o : int\n  communication { var v : int }\n"
            "  composition { mu (press ? v ; o ! v) }\n}\n" + RECEIVER,
            "    b : Button\n    r : Receiver\n    press -> b.press\n    b.o -> c : int -> r.i",
            "b || r",
            "  in press : int",
            PLANT + "environment Bench for Top { plant : Plant\n  plant.press -> press\n  }",
        ),
        "the instants of events at press are not known",
    ),
    "interrupt": (
        program(SENDER + RECEIVER, PAIR, "(s || r) interrupt after 10 ms -> skip"),
        "an interrupt may come at any time",
    ),
    "caught fault": (
        program(SENDER + RECEIVER, PAIR, "(s || r) catch Fault -> skip"),
        "a Fault that is caught may come at any time",
    ),
    "guard on a value": (
        program(
            SENDER + "process Chooser {\n  in i : int\n  communication { var v : int = 0 }\n"
            "  composition { mu ((when v < 5 & i ? v -> skip) [] (after 1 ms -> skip)) }\n}\n",
            "    s : Sender\n    r : Chooser\n    s.o -> c : int -> r.i",
            "s || r",
        ),
        "whether a guard is enabled is not known",
    ),
    "delay on a value": (
        program(
            SENDER + "process Sleeper {\n  in i : int\n  communication { var v : int = 0 }\n"
            "  composition { mu (i ? v ; wait v * 1 ms) }\n}\n",
            "    s : Sender\n    r : Sleeper\n    s.o -> c : int -> r.i",
            "s || r",
        ),
        "the length of a delay is not known",
    ),
    "instant that is waited for": (
        program(
            SENDER + "process Sleeper {\n  in i : int\n  communication { var v : int = 0 }\n"
            "  composition { mu (i ? v ; wait until 5 ms) }\n}\n",
            "    s : Sender\n    r : Sleeper\n    s.o -> c : int -> r.i",
            "s || r",
        ),
        "the length of a delay is not known",
    ),
    "communication on a value": (
        program(
            SENDER + "process Splitter {\n  in i : int\n  out o : int\n  communication { var v : int = 0 }\n"
            "  composition { mu (i ? v ; if v % 2 == 0 then o ! v) }\n}\n" + RECEIVER,
            "    s : Sender\n    m : Splitter\n    r : Receiver\n    s.o -> c : int -> m.i\n    m.o -> d : int -> r.i",
            "s || m || r",
        ),
        "what it does next depends on a value",
    ),
    "an output of a control law decides": (
        program(
            "submodel Law {\n  in x : double\n  out y : double\n  out done : bool\n"
            "  state n : int = 0\n  next n = n + 1\n  y = x\n  done = n >= 3\n}\n"
            "process Mode {\n  in x : double @ 1 ms\n  out y : double @ 1 ms\n"
            "  communication { law : Law  var stop : bool = false  x -> law.x  law.y -> y  law.done -> stop }\n"
            "  composition { stop := false ; mu law until stop }\n}\n" + SENDER + RECEIVER,
            "    m : Mode\n    x -> m.x\n    m.y -> y\n" + PAIR,
            "m || s || r",
            "  in x : double @ 1 ms\n  out y : double @ 1 ms",
            PLANT + "environment Bench for Top { plant : Plant\n  plant.x -> x\n  y -> plant.u\n  }",
        ),
        "what it does next depends on a value",
    ),
    "an output of a control law is read after the exception": (
        program(
            "submodel Law {\n  in x : double\n  out y, z : double\n  y = 2 * x\n  z = 3 * x\n}\n"
            "process Mode {\n  in x : double @ 1 ms\n  out y : double @ 1 ms\n  out o : double\n"
            "  communication { law : Law  var last : double = 0  x -> law.x  law.y -> y  law.z -> last }\n"
            "  composition { (mu law || (wait 5 ms ; raise Enough)) catch Enough -> o ! last }\n}\n"
            "process Taker {\n  in i : double\n  communication { var v : double }\n  composition { mu i ? v }\n}\n",
            "    m : Mode\n    r : Taker\n    x -> m.x\n    m.y -> y\n    m.o -> c : double -> r.i",
            "m || r",
            "  in x : double @ 1 ms\n  out y : double @ 1 ms",
            PLANT + "environment Bench for Top { plant : Plant\n  plant.x -> x\n  y -> plant.u\n  }",
        ),
        "what a cancelled process still assigns is read after the exception",
    ),
    "deadlock": (
        program(
            "process One {\n  in i : int\n  out o : int\n  communication { var v : int = 0 }\n"
            "  composition { mu (i ? v ; o ! v) }\n}\n",
            "    a : One\n    b : One\n    a.o -> c : int -> b.i\n    b.o -> d : int -> a.i",
            "a || b",
        ),
        "it deadlocks",
    ),
    "missed samples": (
        program(
            "process Slow {\n  in x : double @ 1 ms\n  out o : int\n  communication { var v : double }\n"
            "  composition { mu (x ? v ; wait 5 ms ; o ! 1) }\n}\n" + RECEIVER,
            "    b : Slow\n    r : Receiver\n    x -> b.x\n    b.o -> c : int -> r.i",
            "b || r",
            "  in x : double @ 1 ms",
            PLANT + "environment Bench for Top { plant : Plant\n  plant.x -> x\n  }",
        ),
        "samples of x are missed",
    ),
    "too much text": (
        program(
            "process Counter {\n  out o : int\n  communication { var n : int = 0  var m : int = 0 }\n"
            "  composition { mu (n := n * 3 % 97 + 1 ; (if n > 50 then o ! n else m := n)) }\n}\n" + RECEIVER,
            "    s : Counter\n    r : Receiver\n    s.o -> c : int -> r.i",
            "s || r",
        ),
        "times as long as the processes",
    ),
    "too long": (
        program(
            "process Counter {\n  out o : int\n  communication { var n : int = 0 }\n"
            "  composition { mu (o ! n ; n := n + 1) until n == 100000 }\n}\n"
            "process Taker {\n  in i : int\n  communication { var v : int  var n : int = 0 }\n"
            "  composition { mu (i ? v ; n := n + 1) until n == 100000 }\n}\n",
            "    s : Counter\n    r : Taker\n    s.o -> c : int -> r.i",
            "s || r",
        ),
        "turns until it repeats",
    ),
}


@pytest.mark.parametrize(("text", "reason"), REFUSED.values(), ids=REFUSED)
def test_program_is_not_fused(text: str, reason: str) -> None:
    network = optimize(network_of(SourceFile(name="refused.csp", text=text)), BEFORE)
    with pytest.raises(NotStaticError, match=reason):
        fused(network)
    assert fuse(network) is network
    assert reason in explain_fusion(network)[0]


FUSED = {
    "buffer": program(
        SENDER + RECEIVER.replace("mu i ? v", "mu (i ? v ; wait 1 ms)"), PAIR.replace("c : int", "c : int buffer 2"),
        "s || r"
    ),
    "overwriting": program(
        SENDER + RECEIVER.replace("mu i ? v", "mu (i ? v ; wait 3 ms)"), PAIR.replace("c : int", "c : int overwrite 2"),
        "s || r"
    ),
    "an exception in one ends the others": program(
        SENDER.replace("wait 1 ms", "wait 1 ms ; if n == 7 then raise Enough") + RECEIVER, PAIR,
        "(s || r) catch Enough -> skip"
    ),
    "an exception ends the program": program(
        SENDER.replace("wait 1 ms", "wait 1 ms ; if n == 7 then raise Enough") + RECEIVER, PAIR, "s || r"
    ),
    "overflow in one ends the others": program(
        SENDER.replace("n + 1", "n * 2 + 1").replace("1 ms", "100 us") + RECEIVER, PAIR, "s || r"
    ),
    "an element of an array is the target": program(
        SENDER
        + RECEIVER.replace("var v : int ", "var v : int[3] = [0, 0, 0]  var k : int = 0 ")
        .replace("mu i ? v", "mu (i ? v[k] ; k := (k + 1) % 4)"),
        PAIR,
        "s || r",
    ),
    "priorities": program(
        SENDER + RECEIVER, PAIR + "\n    t : Sender\n    u : Receiver\n    t.o -> d : int -> u.i",
        "(s || r) ||> (t || u)"
    ),
    "an alternative chooses on a broadcast": program(
        SENDER + "process Chooser {\n  in i : int\n  communication { var v : int = 0 }\n"
        "  composition { wait 300 us ; mu (i ? v -> skip [] after 700 us -> skip) }\n}\n",
        "    s : Sender\n    r : Chooser\n    t : Chooser\n    s.o -> c : int broadcast -> r.i, t.i",
        "s || r || t",
    ),
    "what happens first is not what happens then": program(
        SENDER.replace("mu (", "o ! 5 ; o ! 6 ; wait 3 ms ; mu (") + RECEIVER, PAIR, "s || r"
    ),
    "a process ends, and another continues": program(
        SENDER.replace("mu (o ! n ; n := n + 1 ; wait 1 ms)", "mu (o ! n ; n := n + 1 ; wait 1 ms) until n == 3")
        + RECEIVER.replace("var v : int", "var v : int  var k : int = 0").replace("mu i ? v", (
            "(mu (i ? v ; k := k + 1) until k == 3) ; mu wait 2 ms"
        )),
        PAIR,
        "s || r",
    ),
    "the present instant, at which a value is offered and not when it passes": program(
        "process Sender {\n  out o : time\n  composition { mu (o ! now ; wait 1 ms) }\n}\n"
        "process Receiver {\n  in i : time\n  communication { var v : time = 0 ms }\n"
        "  composition { wait 300 us ; mu (i ? v ; v := now - v) }\n}\n",
        "    s : Sender\n    r : Receiver\n    s.o -> c : time -> r.i",
        "s || r",
    ),
    "conditions and loops inside those that only compute": program(
        "process Sender {\n  in x : double @ 1 ms\n  out o : int\n  communication { var v : double  var n : int = 0 }\n"
        "  composition {\n    mu (x ? v ; (if v > 0.5 then (if v > 1.5 then n := 2 else n := 1)"
        " else while n % 7 != 0 do n := n + 1) ; o ! n)\n  }\n}\n" + RECEIVER,
        PAIR + "\n    x -> s.x",
        "s || r",
        "  in x : double @ 1 ms",
        PLANT + "environment Bench for Top { plant : Plant\n  plant.x -> x\n  }",
    ),
    "two rates": program(
        "process Fast {\n  in x : double @ 1 ms\n  out o : double\n  communication { var v : double  var w : double }\n"
        "  composition { mu (x ? v ; x ? w ; o ! v + w) }\n}\n"
        "process Slow {\n  in y : double @ 2 ms\n  in i : double\n  out u : double @ 2 ms\n  communication { var v : "
        "double  var w : double }\n"
        "  composition { mu (y ? v ; i ? w ; u ! v - w) }\n}\n",
        "    f : Fast\n    s : Slow\n    x -> f.x\n    y -> s.y\n    f.o -> c : double -> s.i\n    s.u -> u",
        "f || s",
        "  in x : double @ 1 ms\n  in y : double @ 2 ms\n  out u : double @ 2 ms",
        PLANT + "environment Bench for Top { plant : Plant\n  u -> plant.u\n  plant.x -> x\n  plant.y -> y\n  }",
    ),
}  # fmt: skip


COUNTED = program(
    "process Count {\n  out o : int\n  communication { var n : int = 0 }\n"
    "  composition { mu (o ! SENT ; wait 1 ms ; n := n + 1) until n == 20 }\n}\n"
    "process Take {\n  in i : int\n  communication { var v : int  var n : int = 0 }\n"
    "  composition { mu (i ? v ; n := n + 1) until n == 20 }\n}\n",
    "    s : Count\n    r : Take\n    s.o -> c : int -> r.i",
    "s || r",
)


@pytest.mark.parametrize(("sent", "loops"), [("7", 1), ("n", 0), ("7 + n", 0)])
def test_iterations_that_are_only_counted_become_a_loop(sent: str, loops: int) -> None:
    before = optimize(network_of(SourceFile(name="counted.csp", text=COUNTED.replace("SENT", sent))), BEFORE)
    after = fuse(before)
    assert len(after.instances) == 1, explain_fusion(before)
    assert sum(isinstance(part, Repeat) for part in parts(after.class_named("Top"))) == loops
    assert_same(before, after, 30_000_000)


RATES = program(
    "process Fast {\n  in r : double\n  in x : double @ 1 ms\n  out y : double @ 1 ms\n"
    "  communication { var v : double = 0  var w : double = 0 }\n"
    "  composition { mu (r ? w -> skip []> x ? v -> y ! v + w) }\n}\n"
    "process Middle {\n  in r : double\n  in x : double @ 5 ms\n  out o : double\n"
    "  communication { var v : double = 0  var w : double = 0 }\n"
    "  composition { mu (r ? w -> skip []> x ? v -> o ! v - w) }\n}\n"
    "process Slow {\n  in x : double @ 50 ms\n  out o : double\n  communication { var v : double = 0 }\n"
    "  composition { mu (x ? v ; o ! v) }\n}\n",
    "    f : Fast\n    m : Middle\n    s : Slow\n    a -> f.x\n    b -> m.x\n    c -> s.x\n    f.y -> u\n"
    "    m.o -> f.r\n    s.o -> m.r",
    "f ||> m ||> s",
    "  in a : double @ 1 ms\n  in b : double @ 5 ms\n  in c : double @ 50 ms\n  out u : double @ 1 ms",
    PLANT
    + "environment Bench for Top { plant : Plant\n  u -> plant.u\n  plant.x -> a\n  plant.x -> b\n  plant.y -> c\n  }",
)


def test_three_rates_are_loops_in_one_another() -> None:
    before = optimize(network_of(SourceFile(name="rates.csp", text=RATES)), BEFORE)
    after = fuse(before)
    assert len(after.instances) == 1, explain_fusion(before)
    reads = [part for part in parts(after.class_named("Top")) if isinstance(part, ReadValue)]
    assert len(reads) == 3, "no loop is written out in the turns of a slower one"
    assert_same(before, after, 200_000_000)


def test_what_may_fault_is_at_the_place_of_the_process_that_computes_it() -> None:
    """Not at that of the reader, which has waited for it."""
    after = fuse(optimize(network_of(read("models/commstime/commstime.csp")), BEFORE))
    computed = [part for part in parts(after.class_named("Commstime")) if isinstance(part, AssignValue)]
    assert [part.span.text for part in computed if may_fault(part.value)] == ["value + 1"]


@pytest.mark.parametrize("text", FUSED.values(), ids=FUSED)
def test_program_is_fused(text: str) -> None:
    network = network_of(SourceFile(name="fused.csp", text=text))
    before = optimize(network, BEFORE)
    after = fuse(before)
    assert len(after.instances) == 1, explain_fusion(before)
    assert_same(network, after, 50_000_000)


def test_random_static_networks() -> None:
    """Most of them become one process, and all behave as before."""
    counts = {"all": 0, "fused": 0}

    @settings(max_examples=60, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
    @given(static_networks())
    def check(text: str) -> None:
        note(text)
        network = network_of(SourceFile(name="static.csp", text=text))
        after = optimize(network)
        counts["all"] += 1
        counts["fused"] += len(after.instances) == 1
        assert_same(network, after, 25_000_000)

    check()
    assert counts["fused"] > counts["all"] / 2
