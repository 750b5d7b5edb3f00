"""Counterexamples in words: who writes and who reads, and whom a process waits for."""

from __future__ import annotations

from cspdiag.analyses.counterexamples.table import table
from cspdiag.analyses.counterexamples.words import waiting_lines
from tests.verifying import answer_to

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


def test_who_waits_at_a_buffer_waits_for_the_process_behind_it() -> None:
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
