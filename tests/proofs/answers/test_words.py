"""Counterexamples in words: which process writes, which reads, and for which a process waits."""

from __future__ import annotations

from cspdiag.proofs.counterexamples.table import table
from cspdiag.proofs.counterexamples.words import waiting_lines
from tests.support.verifying import answer_to

BUFFERED = """process Client {
  out request : int
  in  reply   : int

  communication { var x : int = 0 }

  composition { (request ! 1 -> skip [] after 1 ms -> skip) ; reply ? x }
}

process Server {
  in  request : int
  out reply   : int

  communication { var y : int = 0 }

  composition { request ? y ; request ? y ; reply ! y }
}

process Both {
  communication {
    client : Client
    server : Server

    client.request -> requests : int buffer 1 -> server.request
    server.reply   -> client.reply
  }

  composition { client || server }
}

assert Both deadlock free
"""


def test_a_process_waiting_at_a_buffer_waits_for_the_one_behind_it() -> None:
    answer = answer_to(BUFFERED)
    assert answer.counterexample is not None
    assert set(waiting_lines(answer.counterexample)) == {
        "`client` waits to read server.reply (case.csp:7), for `server`",
        "`server` waits to read requests (case.csp:16), for `client`",
    }


def test_alternatives_write_and_read_and_memories_have_no_column() -> None:
    answer = answer_to(BUFFERED)
    assert answer.counterexample is not None
    lines = [line.split() for line in table(answer.counterexample).splitlines()]
    assert lines == [
        ["client", "server"],
        ["1", "requests", "1", "!7"],
        ["2", "requests", "?16"],
        ["lines", "of", "case.csp", "!", "writes,", "?", "reads"],
    ]


READS_IN_TIME = """process Main {
  communication {
    var x : int = 0

    channel c : int sync
  }

  composition {
    (skip -> c ! 3 []> skip -> c ! 3) || skip || (wait 1 ms ; ((c ? x) interrupt after 2 ms -> skip)) || mu wait 1 ms
  }
}

assert Main deadlock free
"""


def test_a_process_that_would_have_ended_is_not_reported_as_ended() -> None:
    """The third branch reads at 1 ms, in every run: only a proof without times assumes that it gives up at 3 ms."""
    answer = answer_to(READS_IN_TIME)
    assert answer.outcome == "unknown"
    assert "`3` does not reach `after 2 ms`" in answer.reason
    assert answer.candidate == (
        "after `wait 1 ms` of `3`, `after 2 ms` of `3`:",
        "`1` waits to write c (case.csp:9), for `3`, which would have ended",
    )


def test_a_long_path_to_an_assumption_is_reported_by_its_end() -> None:
    text = READS_IN_TIME.replace("(wait 1 ms ; ", f"({'wait 1 ms ; ' * 7}")
    assert answer_to(text).candidate[0] == "after 8 steps, the last of them " + "`wait 1 ms` of `3`, " * 4 + (
        "`after 2 ms` of `3`:"
    )
