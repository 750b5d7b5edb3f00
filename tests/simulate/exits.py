"""Every way in which a program can end, for every way to start it, with devices whose calls block or not: one process
each, and what it did with its devices.

``python -m tests.simulate.exits`` tries all combinations and lists those that fail; it takes some minutes. The tests
try a selection.
"""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cspdiag.cli.main import main
from tests.support.signals import hear_signals

ROOT = Path(__file__).parents[2]

PROGRAM = """
driver Card python "card.py:Card" {
  out level : double
  in  valve : double
}

driver Lamp python "card.py:Lamp" {
  in light : int
}

submodel Law python "law.py:Law" {
  in  x : double
  out y : double
}

process Main {
  in  level : double @ 10 ms
  out valve : double @ 10 ms safe -1
  out light : int safe 7

  communication {
    law : Law
    level -> law.x
    law.y -> valve
  }

  composition {
    light ! 1 ; mu law
  }
}

environment Bench for Main on miss count {
  card : Card
  lamp : Lamp

  card.level -> level
  valve      -> card.valve
  light      -> lamp.light
}
"""

LAW = """
import atexit
import os
import signal
import sys
import threading
import time


class Mute(Exception):
    def __str__(self):
        raise SystemExit(0)


class Law:
    def __init__(self):
        self.steps = 0
        if os.environ["FAULT"] == "constructor exits":
            raise SystemExit(0)

    def calculate(self, *, x):
        self.steps += 1
        if self.steps == 4:
            fail(os.environ["FAULT"])
        return x


def fail(fault):
    if fault == "body raises":
        raise RuntimeError("no such row")
    if fault == "body exits":
        raise SystemExit(0)
    if fault == "body interrupts":
        raise KeyboardInterrupt
    if fault == "body ends a generator":
        raise GeneratorExit
    if fault == "body raises without a text":
        raise Mute
    if fault == "body forks" and os.fork() == 0:
        signal.alarm(60)
    if fault == "body leaves a thread":
        threading.Thread(target=time.sleep, args=(60,)).start()
    if fault == "body waits at exit":
        atexit.register(time.sleep, 60)
    if fault == "body sets streams":
        sys.stdout = sys.stderr = None
    if fault == "body closes streams":
        sys.stdout.close()
        sys.stderr.close()
    if fault == "body hangs":
        time.sleep(1000)
    while fault == "body hangs for good":
        try:
            while True:
                pass
        except BaseException:
            pass
"""

CARD = """
import os
import signal
import sys
import time

FAULT = os.environ["FAULT"]
PROCESS = os.getpid()


def log(text):
    if os.getpid() != PROCESS:
        text = "child: " + text
    file = os.open("log", os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(file, (text + "\\n").encode())
    os.close(file)


def raise_something(number, frame):
    raise RuntimeError("enough")


def leave(number, frame):
    sys.exit(0)


if FAULT == "handler raises":
    signal.signal(signal.SIGTERM, raise_something)


class Mute(Exception):
    def __str__(self):
        raise SystemExit(0)


def fail(how):
    if how == "raises":
        raise OSError("cable out")
    if how == "interrupts":
        raise KeyboardInterrupt
    if how == "ends a generator":
        raise GeneratorExit
    if how == "raises without a text":
        raise Mute
    if how == "exits":
        sys.exit(0)
    if how == "forks" and os.fork() == 0:
        signal.alarm(60)  # Should it not end by itself.
    if how == "hangs":
        time.sleep(1000)
    while how == "hangs for good":
        try:
            time.sleep(1000)
        except BaseException:
            pass


if FAULT == "import is slow":
    log("import")
    time.sleep(1000)


class Device:
    blocking = os.environ["BLOCKING"] == "1"

    def open(self):
        log(f"{type(self).__name__} open")
        if FAULT == "open forks" and isinstance(self, Card):
            fail("forks")
        if FAULT == "open is slow":
            time.sleep(0.7)
        if FAULT == "default is restored":
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        if FAULT == "handler exits":
            signal.signal(signal.SIGTERM, leave)
        if FAULT == "child" and isinstance(self, Card):
            self.child = os.fork()
            while self.child == 0:
                time.sleep(1000)

    def close(self):
        log(f"{type(self).__name__} close")
        if FAULT == "child" and isinstance(self, Card):
            os.kill(self.child, signal.SIGTERM)
            assert os.waitpid(self.child, 0)[1] == signal.SIGTERM
        if FAULT.startswith("handler"):
            time.sleep(0.3)
        if FAULT.startswith("close ") and isinstance(self, Card):
            fail(FAULT.removeprefix("close "))


class Card(Device):
    def __init__(self):
        self.reads = self.writes = 0

    def read(self, port):
        self.reads += 1
        if self.reads == 4:
            if FAULT in VALUES:
                return VALUES[FAULT]
            if FAULT.startswith("read "):
                fail(FAULT.removeprefix("read "))
        return 0.5

    def write(self, port, value):
        log(f"{port} {value:g}")
        self.writes += 1
        if FAULT.startswith("handler") and value == -1:
            time.sleep(0.3)
        if FAULT.startswith("safe ") and value == -1:
            fail(FAULT.removeprefix("safe "))
        if self.writes == 4 and FAULT.startswith("write "):
            fail(FAULT.removeprefix("write "))


class Lamp(Device):
    def write(self, port, value):
        log(f"{port} {value}")


VALUES = {"text": "1.5", "nothing": None, "huge": 10**400, "NaN": float("nan")}
"""

Signals = tuple[int, ...]


@dataclass(frozen=True)
class WayOut:
    """A way to end: what goes wrong in the program, which signals arrive, 50 ms apart, and the expected result."""

    name: str
    code: int
    says: str
    """Words that its report contains."""
    fault: str = ""
    signals: Signals = ()
    opened: tuple[str, ...] = ("Card", "Lamp")
    """Devices that were opened, and so have to be released and closed."""
    real_time_only: bool = False
    not_blocking_only: bool = False


WAYS = (
    WayOut("SIGINT", 130, "stopped by SIGINT", signals=(signal.SIGINT,)),
    WayOut("SIGTERM", 143, "stopped by SIGTERM", signals=(signal.SIGTERM,)),
    WayOut("SIGHUP", 129, "stopped by SIGHUP", signals=(signal.SIGHUP,)),
    WayOut("SIGQUIT", 131, "stopped by SIGQUIT", signals=(signal.SIGQUIT,)),
    WayOut("SIGUSR1", 138, "stopped by SIGUSR1", signals=(signal.SIGUSR1,)),
    WayOut("SIGTRAP", 133, "stopped by SIGTRAP", signals=(signal.SIGTRAP,)),
    WayOut("SIGSYS", 159, "stopped by SIGSYS", signals=(signal.SIGSYS,)),
    WayOut("a real-time signal", 163, "stopped by SIGRTMIN+1", signals=(signal.SIGRTMIN + 1,)),
    WayOut("SIGPIPE is ignored", 143, "stopped by SIGTERM", signals=(signal.SIGPIPE, signal.SIGTERM)),
    WayOut("two signals", 143, "stopped by SIGTERM", signals=(signal.SIGTERM, signal.SIGTERM)),
    WayOut("six signals", 130, "stopped by SIGINT", signals=(signal.SIGINT, signal.SIGTERM) * 3),
    WayOut("a signal during import", 143, "stopped by SIGTERM before", "import is slow", (signal.SIGTERM,), ()),
    WayOut("a signal during open", 143, "stopped by SIGTERM", "open is slow", (signal.SIGTERM,), ("Card",)),
    WayOut("a signal while a read hangs", 143, "stopped by SIGTERM", "read hangs", (signal.SIGTERM,)),
    WayOut(
        "a signal while a read hangs for good", 1, "driver Card failed to read at port Main.level: TimeoutError",
        "read hangs for good", (signal.SIGTERM,), not_blocking_only=True,
    ),
    WayOut("a signal while a body hangs", 143, "stopped by SIGTERM", "body hangs", (signal.SIGTERM,)),
    WayOut(
        "a signal while a body hangs for good", 143, "Main.law (main.csp:11), at law.py:", "body hangs for good",
        (signal.SIGTERM,),
    ),
    WayOut("a driver restores the default", 143, "stopped by SIGTERM", "default is restored", (signal.SIGTERM,)),
    WayOut(
        "a handler raises", 1, "the handler of SIGTERM (raise_something, card.py:", "handler raises",
        (signal.SIGTERM,) * 6,
    ),
    WayOut(
        "a handler exits", 1, "the handler of SIGTERM (leave, card.py:", "handler exits", (signal.SIGTERM,) * 6,
    ),
    WayOut("a child of a driver", 143, "stopped by SIGTERM", "child", (signal.SIGTERM,)),
    *(
        WayOut(f"a child comes back from {what}", 143, "stopped by SIGTERM", f"{fault} forks", (signal.SIGTERM,))
        for what, fault in (
            ("open", "open"), ("a read", "read"), ("a write", "write"), ("a safe write", "safe"), ("close", "close"),
            ("a body", "body"),
        )
    ),
    WayOut("a read raises", 1, "driver Card failed to read at port Main.level: OSError: cable out", "read raises"),
    WayOut("a read exits", 1, "driver Card failed to read at port Main.level: SystemExit: 0", "read exits"),
    WayOut(
        "a read interrupts", 1, "driver Card failed to read at port Main.level: KeyboardInterrupt", "read interrupts"
    ),
    WayOut(
        "a read ends a generator", 1, "driver Card failed to read at port Main.level: GeneratorExit",
        "read ends a generator",
    ),
    WayOut(
        "a read raises without a text", 1, (
            "driver Card failed to read at port Main.level: Mute: (its text cannot be made"
        ),
        "read raises without a text",
    ),
    WayOut("a read hangs", 1, "Main.level", "read hangs", real_time_only=True),
    WayOut("a read hangs for good", 1, "Main.level", "read hangs for good", real_time_only=True),
    WayOut("a write raises", 1, "driver Card failed to write at port Main.valve: OSError: cable out", "write raises"),
    WayOut("a write exits", 1, "driver Card failed to write at port Main.valve: SystemExit: 0", "write exits"),
    WayOut(
        "a write hangs", 1, "driver Card failed to write at port Main.valve: TimeoutError", "write hangs",
        real_time_only=True,
    ),
    WayOut(
        "a write raises without a text", 1, "driver Card failed to write at port Main.valve: Mute: (its text cannot",
        "write raises without a text",
    ),
    WayOut("a text", 1, "driver Card failed to read at port Main.level: TypeError: '1.5' is not a number", "text"),
    WayOut("nothing", 1, "driver Card failed to read at port Main.level: TypeError: None is not a number", "nothing"),
    WayOut("a huge number", 1, "driver Card failed to read at port Main.level: Fault: 1", "huge"),
    WayOut("NaN", 1, "Fault: a real value is infinite or not a number, in Main.law (main.csp:11)", "NaN"),
    WayOut("a body raises", 1, "RuntimeError: no such row", "body raises"),
    WayOut("a body sets streams", 143, "stopped by SIGTERM", "body sets streams", (signal.SIGTERM,)),
    WayOut("a body closes streams", 143, "stopped by SIGTERM", "body closes streams", (signal.SIGTERM,)),
    WayOut("a constructor exits", 1, "SystemExit: 0", "constructor exits", opened=()),
    WayOut("a body exits", 1, "SystemExit: 0, in Main.law (main.csp:11)", "body exits"),
    WayOut("a body interrupts", 1, "KeyboardInterrupt, in Main.law (main.csp:11)", "body interrupts"),
    WayOut("a body ends a generator", 1, "GeneratorExit, in ", "body ends a generator"),
    WayOut(
        "a body raises without a text", 1, "Mute: (its text cannot be made: SystemExit), in Main.law",
        "body raises without a text",
    ),
    WayOut(
        "a body hangs", 1, "Main.law (main.csp:11), at law.py:", "body hangs", real_time_only=True,
    ),
    WayOut(
        "a body hangs for good", 1, "Main.law (main.csp:11), at law.py:", "body hangs for good", real_time_only=True,
    ),
    WayOut(
        "a program spins", 1, "Main (spinning.csp:28) has not finished its step within 2 s", "program spins",
        real_time_only=True,
    ),
    WayOut(
        "a safe write raises", 1, "driver Card failed to write at port Main.valve: OSError: cable out", "safe raises",
        (signal.SIGTERM,),
    ),
    WayOut(
        "a safe write hangs", 1, "driver Card failed to write at port Main.valve: TimeoutError", "safe hangs",
        (signal.SIGTERM,),
    ),
    WayOut(
        "a safe write interrupts", 1, "driver Card failed to write at port Main.valve: KeyboardInterrupt",
        "safe interrupts", (signal.SIGTERM,),
    ),
    WayOut(
        "a close interrupts", 1, "driver Card failed to close at port Main.level: KeyboardInterrupt",
        "close interrupts", (signal.SIGTERM,),
    ),
    WayOut(
        "a close raises", 1, "driver Card failed to close at port Main.level: OSError: cable out", "close raises",
        (signal.SIGTERM,),
    ),
)  # fmt: skip

STARTS = ("run -O0", "run -O1", "package -O0", "package -O1")
CLOCKS = ("virtual time", "real time")


@dataclass
class Seen:
    """What a process has done: its exit code, all its output, and the calls of its drivers."""

    code: int
    text: str
    calls: list[str] = field(default_factory=list)

    def complaints(self, way: WayOut) -> list[str]:
        """The expectations that are not met."""
        found = []
        if self.code != way.code:
            found.append(f"the exit code is {self.code} and not {way.code}")
        if "Traceback" in self.text or "never awaited" in self.text:
            found.append("there is a traceback")
        if way.says not in self.text:
            found.append(f"it does not say: {way.says}")
        if self.text.count("driver Card failed") > 1:
            found.append("it says twice what driver Card failed to do")
        for device, port, safe in (("Card", "valve", "-1"), ("Lamp", "light", "7")):
            if device not in way.opened:
                continue
            writes = [call for call in self.calls if call.startswith(f"{port} ")]
            if writes.count(f"{port} {safe}") != 1:
                found.append(f"{port} is released {writes.count(f'{port} {safe}')} times")
            if not writes or writes[-1] != f"{port} {safe}":
                found.append(f"the last value of {port} is not safe")
        if any(call.startswith("child: ") for call in self.calls):
            found.append("a child continues to use the devices")
        for device in ("Card", "Lamp"):
            for operation in ("open", "close"):
                if self.calls.count(f"{device} {operation}") != (device in way.opened):
                    found.append(f"{device} has {self.calls.count(f'{device} {operation}')} calls of {operation}")
        return found


def prepare(folder: Path) -> Path:
    """The program, and its packages at both levels, in an empty folder.

    It only counts missed samples, because a busy machine may let it miss some; ``strict`` does not. ``spinning`` takes
    no time and never waits.
    """
    (folder / "card.py").write_text(CARD)
    (folder / "law.py").write_text(LAW)
    programs = {
        "main": PROGRAM,
        "strict": PROGRAM.replace(" on miss count", ""),
        "spinning": PROGRAM.replace("mu law", "law ; mu wait pause").replace(
            "communication {", "communication { var pause : time = 0 ms", 1
        ),
    }
    for name, text in programs.items():
        program = folder / f"{name}.csp"
        program.write_text(text)
        for level in (0, 1):
            assert main(["compile", str(program), f"-O{level}", "-o", str(folder / f"O{level}")]) == 0
    return folder


def command(folder: Path, name: str, start: str, clock: str, *options: str) -> tuple[list[str], dict[str, str]]:
    """The command that starts the program of that name, and the environment variables for finding it."""
    how, _, level = start.partition(" ")
    real = ["--real-time"] if clock == "real time" else []
    if how == "run":
        arguments = [sys.executable, "-m", "cspdiag", "run", str(folder / f"{name}.csp"), level, *real, *options]
        return arguments, {"PYTHONPATH": str(ROOT)}
    place = folder / level.removeprefix("-") / name
    return [sys.executable, "-m", name, *real, *options], {"PYTHONPATH": str(place)}


def started(
    folder: Path,
    start: str,
    clock: str,
    *,
    files: Sequence[str] = (),
    blocking: bool = False,
    fault: str = "",
    name: str = "main",
    **given: object,
) -> subprocess.Popen[bytes]:
    """A process of it that logs the calls of its drivers to ``log`` in ``folder``, its working directory."""
    arguments, variables = command(folder.parent, name, start, clock, *files)
    environment = {**os.environ, **variables, "FAULT": fault, "BLOCKING": str(int(blocking))}
    folder.mkdir(exist_ok=True)
    settings: dict[str, object] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, **given}
    return subprocess.Popen(arguments, cwd=folder, env=environment, **settings)  # type: ignore[call-overload, no-any-return]


def wait_until(holds: Callable[[], bool], process: subprocess.Popen[bytes]) -> None:
    """Wait for something that a process is to do, or for its end."""
    for _ in range(3000):
        if holds() or process.poll() is not None:
            return
        time.sleep(0.01)
    raise AssertionError("it does not happen")


def log_of(folder: Path) -> list[str]:
    path = folder / "log"
    return path.read_text().splitlines() if path.exists() else []


def try_way(folder: Path, way: WayOut, start: str, clock: str, *, blocking: bool) -> Seen:
    """Start the program in a folder of its own, let the planned events happen, and wait for its end."""
    own = Path(tempfile.mkdtemp(dir=folder))
    # A blocking device that falls silent is only noticed by a program that does not merely count missed samples.
    name = "strict" if blocking and way.fault.startswith("read hangs") and not way.signals else "main"
    if way.fault == "program spins":
        name = "spinning"
    process = started(own, start, clock, blocking=blocking, fault=way.fault, name=name)
    try:
        if way.signals:
            needed = 1 if way.fault in ("open is slow", "import is slow") else 3 if " hangs" in way.fault else 6
            wait_until(lambda: len(log_of(own)) >= needed, process)
            if way.fault.startswith(("read hangs", "body hangs")):
                time.sleep(0.3)
            for number in way.signals:
                if process.poll() is None:
                    process.send_signal(number)
                time.sleep(0.05 if len(way.signals) > 1 else 0)
        text, _ = process.communicate(timeout=30)
        return Seen(process.returncode, text.decode(), log_of(own))
    except subprocess.TimeoutExpired:
        process.kill()
        text, _ = process.communicate()
        return Seen(process.returncode, "it hangs\n" + text.decode(), log_of(own))
    finally:
        process.kill()
        process.wait()


def hunt() -> int:
    """All combinations."""
    hear_signals()
    wrong = tried = 0
    with tempfile.TemporaryDirectory() as name:
        folder = prepare(Path(name))
        for way, start, clock, blocking in itertools.product(WAYS, STARTS, CLOCKS, (False, True)):
            if way.real_time_only and clock != "real time":
                continue
            if way.not_blocking_only and blocking and clock == "real time":
                continue
            tried += 1
            seen = try_way(folder, way, start, clock, blocking=blocking)
            complaints = seen.complaints(way)
            if complaints:
                wrong += 1
                shape = f"{way.name}, {start}, {clock}{', blocking' if blocking else ''}"
                print(f"{shape}: {'; '.join(complaints)}\n{seen.text}\n{seen.calls[-8:]}", flush=True)
    print(f"{tried} tried, {wrong} do not hold")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(hunt())
