"""What docs/devices.md shows works as it is shown."""

from __future__ import annotations

import ast
import re
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import cspdiag
from cspdiag.devices.catalogue import DEVICES

PAGE = (Path(__file__).parents[2] / "docs" / "devices.md").read_text(encoding="utf-8")
PROGRAMS = re.findall(r"```csp\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("program", PROGRAMS, ids=[text.split("(")[0].split(" device")[0] for text in PROGRAMS])
def test_programs_are_right(program: str) -> None:
    assert cspdiag.parse(program).check() == []


def test_each_device_has_a_section_and_a_row_with_its_extra() -> None:
    for device in DEVICES.values():
        install = f"`pip install 'cspdiag[{device.extra}]'`" if device.extra else "nothing"
        row = rf"^\| \[`{device.name}`\]\(#{device.name}\) \| .* \| {re.escape(install)} \|"
        assert re.search(row, PAGE, re.MULTILINE)
        assert f"\n## {device.name}\n" in PAGE
    for device in DEVICES.values():
        section = PAGE.partition(f"\n## {device.name}\n")[2].partition("\n## ")[0]
        for port in device.outputs or ():
            assert f"`{port.names[0]}`" in section


def _is_free(port: int) -> bool:
    """Whether nobody listens: then a datagram is refused."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.settimeout(0.05)
        probe.connect(("127.0.0.1", port))
        probe.send(b"{}")
        try:
            probe.recv(10)
        except ConnectionRefusedError:
            return True
        except TimeoutError:
            pass
    return False


def test_the_first_example_answers_as_shown() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as unused:
        unused.bind(("127.0.0.1", 0))
        port = int(unused.getsockname()[1])
    shell = re.search(r"```sh\npython3 -c '\n(.*?)'\n```", PAGE, re.DOTALL)
    shown = re.search(r"It prints `(b'.*?') (b'.*?')`\. .* the last datagram is `(.*?)`", PAGE)
    assert shell is not None
    assert shown is not None
    script = shell[1].replace("5005", str(port)) + "\nwhile True: print(s.recv(100), flush=True)\n"
    printed: list[str] = []

    def send() -> None:
        while _is_free(port):
            time.sleep(0.02)
        process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        for line in process.stdout:
            printed.append(line.strip())
            if str(shown[3]) in line:
                break
        process.kill()
        process.wait()
        process.stdout.close()

    thread = threading.Thread(target=send)
    thread.start()
    text = PROGRAMS[0].replace("(port = 5005)", f"(port = {port})")
    run = cspdiag.parse(text).run(real_time=True, until="1 s")
    thread.join()
    assert run.outcome.ended == "time limit"
    assert printed[0] == f"{shown[1]} {shown[2]}"
    assert ast.literal_eval(printed[-1]).decode() == shown[3]
