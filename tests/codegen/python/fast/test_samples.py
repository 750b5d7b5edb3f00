"""What optimized processes do with samples that arrive in turn, and whose name a law has while nothing can see it."""

from __future__ import annotations

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.simulate.run.package import LoadedPackage

LAW = """
submodel Law { in u : double  out y : double  y = 2 * u }
process Top {
  in u : double @ 1 ms
  out y : double @ 1 ms
  communication { law : Law  var v : double  %s  law.y -> y }
  composition { %s }
}
submodel Plant { out u : double  u = %s }
environment Bench for Top { plant : Plant  plant.u -> u  y -> _ }
"""

ALTERNATIVE = """
process Top {
  in u : double @ 1 ms
  in b : int
  out y : double @ 1 ms
  communication { var v : double  var n : int }
  composition { mu (b ? n -> skip [] u ? v -> y ! v %s) }
}
"""


def no_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def generated_from(text: str) -> dict[str, str]:
    network = pipeline.build(SourceFile(name="top.csp", text=text), no_file).network
    assert network is not None
    return pipeline.generate(network, no_file, level=1, observed=True)


def generated(*details: str) -> dict[str, str]:
    return generated_from(LAW % details)


def steps(*details: str) -> str:
    return generated(*details)["top/top.py"].partition("def steps")[2]


def test_a_law_that_a_loop_runs_alone_is_entered_once() -> None:
    before, _, loop = steps("u -> law.u", "mu law", "1").partition("while True:")
    assert "me.process = law_law" in before
    assert "me.process = law_law" not in loop


def test_a_law_in_a_loop_with_others_is_entered_and_left_in_each_iteration() -> None:
    loop = steps("u -> law.u", "mu (law ; u ? v)", "1").partition("while True:")[2]
    assert "me.process = law_law" in loop
    assert loop.rstrip().count("me.process = self") == 2  # also where it fails


def test_a_law_of_which_nothing_is_seen_is_not_entered_but_fails_under_its_name() -> None:
    program = generated("v -> law.u", "mu (u ? v ; law)", "1e308")
    assert "me.process" not in program["top/top.py"]
    package = LoadedPackage("top", program)
    environment = package.module("environments").ENVIRONMENTS["Bench"]()
    outcome = package.module("network").build(environment.drivers).run(environment, until=10_000_000)
    assert outcome.ended == "failed"
    assert "Top.law" in str(outcome.error)


def test_an_alternative_is_announced_to_a_sampled_input_until_its_session_has_begun() -> None:
    loop = generated_from(ALTERNATIVE % "")["top/top.py"].partition("while not ready:")[2]
    announced, _, parked = loop.partition("else:")
    assert "_guards.attend:" in announced
    assert ".wait(-1)" in announced
    assert ".park(me, -1)" in parked


def test_an_alternative_with_a_time_out_lets_the_runtime_begin_that() -> None:
    text = generated_from(ALTERNATIVE % "[] after 5 ms -> skip")["top/top.py"]
    assert ".wait(-1)" in text
    assert ".park(" not in text
