"""An engine for tests of the server: it repeats what it is asked, and its sessions send frames of fifty signals."""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

SIGNALS = [f"signal{number}" for number in range(50)]
_lock = threading.Lock()
_stopped = threading.Event()


def send(message: dict[str, Any]) -> None:
    with _lock:
        sys.stdout.write(json.dumps(message) + "\n")
        sys.stdout.flush()


def frames() -> None:
    """Sixty a second, with a value for each millisecond."""
    begin = 0
    started = time.monotonic()
    while not _stopped.wait(max(0.0, started + begin / 1000 - time.monotonic())):
        times = [1_000_000 * (begin + number) for number in range(17)]
        signals = {name: {"t": times, "v": [float(time) for time in times]} for name in SIGNALS}
        frame = {"session": "1", "from": times[0], "to": times[-1], "signals": signals, "communications": []}
        send({"method": "frame", "params": frame})
        begin += 17


def main(file: str) -> None:
    for line in sys.stdin:
        request = json.loads(line)
        method, params = request["method"], request["params"]
        result: Any = {"method": method, "params": params}
        if method == "hello":
            with open(file, encoding="utf-8") as text:
                result = {"program": {"files": {"a.csp": text.read()}, "main": "a.csp"}}
        if method == "start":
            result = {"session": "1"}
        if method == "play":
            threading.Thread(target=frames, daemon=True).start()
        if method in ("verify", "stop"):
            time.sleep(params.get("seconds", 0))
        if method == "format":
            send({"id": request["id"], "error": {"message": "no", "help": "do"}})
            continue
        if method in ("explain", "step"):
            sys.exit(3)
        send({"id": request["id"], "result": result})
        if params.get("ends"):
            send({"method": "ended", "params": {"session": "1", "reason": "fault"}})
    _stopped.set()
    with open(f"{file}.released", "a", encoding="utf-8") as text:
        text.write("released\n")


if __name__ == "__main__":
    main(sys.argv[1])
