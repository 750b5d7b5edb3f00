"""``python -m cspdiag.studio.engine``: the engine on standard input and output, one message a line, as JSON."""

from __future__ import annotations

import json
import sys
from typing import Any

from cspdiag.studio.engine.engine import Engine


def main() -> None:
    """Answer requests until the input ends."""
    output = sys.stdout
    # Whatever a program prints does not belong to an answer.
    sys.stdout = sys.stderr

    def send(message: dict[str, Any]) -> None:
        output.write(json.dumps(message, allow_nan=False) + "\n")
        output.flush()

    engine = Engine(send)
    for line in sys.stdin:
        if line.strip():
            try:
                message = json.loads(line)
            except ValueError:
                message = None
            send(engine.request(message))


if __name__ == "__main__":
    main()
