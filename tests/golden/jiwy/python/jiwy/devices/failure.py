"""What devices raise."""

from __future__ import annotations

import importlib
from typing import Any


class DeviceError(Exception):
    """A device cannot be used (any more); the text says why, and what to do."""


def library(module: str, package: str, extra: str) -> Any:
    """A library that only some devices need. Raises DeviceError, with the command that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        if error.name is not None and not module.startswith(error.name):
            raise
        raise DeviceError(f"{package} is not installed: pip install 'cspdiag[{extra}]'") from None


def no_permission(what: str, group: str) -> DeviceError:
    """The error for a file that belongs to a group of users."""
    return DeviceError(f"no permission for {what}: sudo usermod -aG {group} $USER, then log in again")
