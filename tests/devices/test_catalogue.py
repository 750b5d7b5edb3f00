"""What the catalogue of devices says, against the classes, the extras and the language."""

from __future__ import annotations

import importlib
import inspect
import re
import tomllib
from pathlib import Path

import pytest

import cspdiag
from cspdiag.cli.main import main
from cspdiag.devices.catalogue import DEVICES, Device

ROOT = Path(__file__).parents[2]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]

all_devices = pytest.mark.parametrize("device", DEVICES.values(), ids=list(DEVICES))


def _declared(device: Device) -> str:
    """A driver with everything that the device offers."""
    parameters = [f"{p.name}: {p.type}{'' if p.default is None else f' = {p.default}'}" for p in device.parameters]
    if device.outputs is None:
        type_ = device.values[0]
        ports = f"out given : {type_}  in taken : {type_}"
        if device.address is not None:
            literal = {"int": "3", "text": '"a"'}[device.address.type]
            parameters += [
                f"{port}_{device.address.name}: {device.address.type} = {literal}" for port in ("given", "taken")
            ]
    else:
        ports = "  ".join(f"out {name} : {port.type}" for port in device.outputs for name in port.names)
    return f'driver X({", ".join(parameters)}) device "{device.name}" {{ {ports} }}'


@all_devices
def test_a_driver_can_declare_all_that_a_device_offers(device: Device) -> None:
    assert cspdiag.parse(_declared(device)).check() == []


@all_devices
def test_the_class_takes_the_parameters_with_their_defaults(device: Device) -> None:
    """The libraries behind it are not imported for that."""
    class_ = getattr(importlib.import_module(f"cspdiag.devices.{device.module}"), device.class_)
    taken = {
        name: parameter.default
        for name, parameter in inspect.signature(class_).parameters.items()
        if parameter.kind is parameter.KEYWORD_ONLY
    }
    scale = {"ms": 10**6, "s": 10**9}

    def value(text: str, type_: str) -> object:
        match type_:
            case "time":
                number, unit = text.split()
                return int(number) * scale[unit]
            case "text":
                return text.strip('"')
            case "bool":
                return text == "true"
        return float(text) if type_ == "double" else int(text)

    offered = {
        p.name: inspect.Parameter.empty if p.default is None else value(p.default, p.type) for p in device.parameters
    }
    assert taken == offered


@all_devices
def test_its_extra_installs_what_it_needs(device: Device) -> None:
    assert tuple(EXTRAS.get(device.extra, ())) == device.requirements
    assert set(device.requirements) <= set(EXTRAS["dev"])


@all_devices
def test_it_is_described(device: Device, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["devices", device.name]) == 0
    shown = capsys.readouterr().out
    for parameter in device.parameters:
        assert f"\n  {parameter.name}: {parameter.type}" in shown


def test_all_devices_are_listed_with_what_to_install(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> str:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", missing)
    assert main(["devices"]) == 0
    shown = capsys.readouterr().out
    for device in DEVICES.values():
        assert f"\n{device.name} " in f"\n{shown}"
        assert not device.requirements or f"pip install 'cspdiag[{device.extra}]'" in shown


def test_a_misspelt_device_is_refused_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["devices", "gampad"]) == 2
    assert "there is no device 'gampad' (did you mean gamepad?)" in capsys.readouterr().err


def test_a_missing_library_is_reported_with_the_command_that_installs_it() -> None:
    from cspdiag.devices.failure import DeviceError, library

    with pytest.raises(DeviceError, match=r"^nothing-such is not installed: pip install 'cspdiag\[some\]'$"):
        library("nothing_such", "nothing-such", "some")


def test_a_package_carries_the_devices_that_it_names_and_nothing_of_cspdiag(tmp_path: Path) -> None:
    text = 'driver Peer device "udp" { out x : double }\n'
    text += "process Main { in x : double @ 1 ms  communication { var a : double = 0 }  composition { x ? a } }\n"
    text += "environment Bench for Main { peer : Peer  peer.x -> x }\n"
    files = cspdiag.parse(text).compile()
    carried = {path.rpartition("/")[2] for path in files if "/devices/" in path}
    assert carried == {"__init__.py", "udp.py", "messages.py", "failure.py"}
    carried_texts = [text for path, text in files.items() if "/devices/" in path]
    assert not any(re.search(r"^\s*(from|import) cspdiag", text, re.MULTILINE) for text in carried_texts)


def test_c_refuses_a_device_and_says_what_to_write() -> None:
    text = 'driver Peer device "udp" { out x : double }\n'
    text += "process Main { in x : double @ 1 ms  communication { var a : double = 0 }  composition { x ? a } }\n"
    text += "environment Bench for Main { peer : Peer  peer.x -> x }\n"
    with pytest.raises(cspdiag.TargetError, match=r'the device "udp"(.|\n)*in C: `driver Peer c "udp.c"`'):
        cspdiag.parse(text).run(target="c", until="1 s")
