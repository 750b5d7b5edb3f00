"""Counterexamples that the program does not follow are not a reason to give up: another one may be real."""

from __future__ import annotations

from tests.support.verifying import answers_to

GEARBOX = """
exception Stuck

/// Opens and closes a clutch, which takes as long as its position says.
process Clutch {
  in  wish     : bool
  out done     : bool
  in  position : double @ 5 ms

  communication {
    var opened : bool   = false
    var now    : double = 0
  }

  composition {
    mu (
      wish ? opened ;
      (mu position ? now until now > 0.9) interrupt after 800 ms -> raise Stuck ;
      done ! opened
    )
  }
}

process Shifter {
  in  lever  : int
  in  moved  : bool
  out clutch : bool
  out torque : bool

  communication {
    var gear  : int  = 0
    var moves : bool = false
  }

  composition {
    mu (lever ? gear ; torque ! false ; clutch ! true ; moved ? moves ; torque ! true)
  }
}

process Gearbox {
  in  lever    : int
  in  position : double @ 5 ms
  out torque   : bool

  communication {
    clutch  : Clutch
    shifter : Shifter

    lever          -> shifter.lever
    position       -> clutch.position
    shifter.clutch -> clutch.wish
    clutch.done    -> shifter.moved
    shifter.torque -> torque
  }

  composition { mu ((clutch || shifter) catch Stuck -> skip) }
}

process OffAndOn {
  out torque : bool

  composition { mu (torque ! false ; torque ! true) }
}
"""


def test_a_sample_that_is_never_missed_does_not_hide_what_a_time_out_does() -> None:
    (answer,) = answers_to({"case.csp": f"{GEARBOX}\nassert Gearbox refines OffAndOn hide lever, position\n"})
    assert answer.outcome == "refuted"
    assert answer.replayed
    assert answer.counterexample is not None
    steps = [f"{step.kind} {step.value or ''}".strip() for step in answer.counterexample.steps if step.shown]
    assert "miss" not in steps
    assert [step for step in steps if step.startswith(("external false", "exception"))] == [
        "external false",
        "exception",
        "external false",
    ]


PROMPT = """
process Client {
  in  answer   : int
  out question : int

  communication { var sent : int = 0 }

  composition { mu (question ! 1 ; (answer ? sent -> skip [] after 5 ms -> skip)) }
}

process Server {
  in  question : int
  out answer   : int

  communication { var asked : int = 0 }

  composition { mu (question ? asked ; answer ! asked) }
}

process Both {
  communication {
    client : Client
    server : Server

    client.question -> server.question
    server.answer   -> client.answer
  }

  composition { client || server }
}

assert Both deadlock free
"""


def test_the_first_counterexample_is_reported_if_there_is_no_other() -> None:
    (answer,) = answers_to({"case.csp": PROMPT})
    assert answer.outcome == "unknown"
    assert "before `after 5 ms`" in answer.reason


POLLED = """
process Slave {
  in  request : bool
  in  fail    : bool
  out answer  : bool

  communication { var asked : bool = false  var dead : bool = false }

  composition { mu (request ? asked -> answer ! true [] fail ? dead -> skip) until dead }
}

process Master {
  in  answer  : bool
  out request : bool
  out lost    : bool

  communication { var sent : bool = false }

  composition { mu (request ! true -> answer ? sent [] after 3 ms -> lost ! true) }
}

process Bus {
  in  fail : bool
  out lost : bool

  communication {
    master : Master
    slave  : Slave

    master.request -> slave.request
    slave.answer   -> master.answer
    fail           -> slave.fail
    master.lost    -> lost
  }

  composition { master || slave }
}

process NeverLost {
  out lost : bool

  composition { stop }
}

assert Bus refines NeverLost hide fail
"""


def test_a_time_out_occurs_if_no_process_is_ready() -> None:
    (answer,) = answers_to({"case.csp": POLLED})
    assert answer.outcome == "refuted"
    assert answer.replayed
    assert answer.counterexample is not None
    reported = [
        (step.kind, [party.name for party in step.parties]) for step in answer.counterexample.steps if step.shown
    ]
    assert reported == [("external", ["slave"]), ("time", ["master"]), ("external", ["master"])]


RESOURCES = """
process Resource {
  in take[2], give[2] : bool

  communication { var taken : bool = false }

  composition { mu (take[0] ? taken -> give[0] ? taken [] take[1] ? taken -> give[1] ? taken) }
}

process Robot {
  out takeFirst, takeSecond, giveSecond, giveFirst : bool

  composition { mu (takeFirst ! true ; takeSecond ! true ; wait 20 ms ; giveSecond ! true ; giveFirst ! true) }
}

process Cell {
  communication {
    left    : Robot
    right   : Robot
    gripper : Resource
    belt    : Resource

    left.takeFirst   -> gripper.take[0]
    left.giveFirst   -> gripper.give[0]
    left.takeSecond  -> belt.take[0]
    left.giveSecond  -> belt.give[0]
    right.takeFirst  -> belt.take[1]
    right.giveFirst  -> belt.give[1]
    right.takeSecond -> gripper.take[1]
    right.giveSecond -> gripper.give[1]
  }

  composition { left || right || gripper || belt }
}

assert Cell terminates
"""


def test_a_stuck_process_does_not_terminate() -> None:
    (answer,) = answers_to({"case.csp": RESOURCES})
    assert answer.outcome == "refuted"
    assert answer.replayed
    assert answer.question.claim == "terminates"
    assert answer.counterexample is not None
    assert answer.counterexample.failure in ("deadlock", "no termination")
