"""Lines of a GPIO chip of Linux, with gpiod (version 2)."""

from __future__ import annotations

import errno
import glob
import os
from collections.abc import Mapping, Sequence
from typing import Any

from .failure import DeviceError, library, no_permission
from .messages import Use


class Gpio:
    """Lines of ``chip``: each port has a ``PORT_line``, the number of its line there.

    ``bias`` of inputs is ``as_is``, ``pull_up``, ``pull_down`` or ``disabled``; with ``active_low`` a line is true when
    its voltage is low. Outputs are false until they are written.
    """

    needs_real_time = True

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        chip: str = "/dev/gpiochip0",
        bias: str = "as_is",
        active_low: bool = False,
        **lines: int,
    ) -> None:
        self.name = f"gpio {chip}"
        self._chip = chip
        self._bias = bias
        self._active_low = active_low
        self._lines = {port: lines[f"{port}_line"] for port in (*outputs, *inputs)}
        self._outputs, self._inputs = tuple(outputs), tuple(inputs)
        self._gpiod: Any = None
        self._request: Any = None

    def open(self) -> None:
        """Request the lines. Raises DeviceError."""
        self._gpiod = library("gpiod", "gpiod", "gpio")
        try:
            self._request = self._gpiod.request_lines(self._chip, consumer="cspdiag", config=self._settings())
        except OSError as error:
            raise self._explained(error) from None

    def _settings(self) -> dict[int, Any]:
        line = self._gpiod.line
        bias = getattr(line.Bias, self._bias.upper(), None)
        if bias is None:
            raise DeviceError(f'bias "{self._bias}" is not as_is, pull_up, pull_down or disabled')
        read = self._gpiod.LineSettings(direction=line.Direction.INPUT, bias=bias, active_low=self._active_low)
        written = self._gpiod.LineSettings(direction=line.Direction.OUTPUT, active_low=self._active_low)
        settings = {self._lines[port]: read for port in self._outputs}
        return settings | {self._lines[port]: written for port in self._inputs}

    def _explained(self, error: OSError) -> DeviceError:
        if error.errno == errno.EACCES:
            return no_permission(self._chip, "gpio")
        if error.errno == errno.ENOENT:
            others = ", ".join(_chips()) or "none"
            return DeviceError(f"there is no such chip (there are: {others})")
        if error.errno == errno.EBUSY:
            return DeviceError("another program, or the kernel, uses one of the lines: gpioinfo shows which")
        if error.errno == errno.EINVAL:
            return DeviceError(f"the chip does not have one of the lines {sorted(self._lines.values())}: see gpioinfo")
        return DeviceError(f"{error.strerror or error}")

    def close(self) -> None:
        """Release the lines, which keep their last values or not, as the chip does."""
        self._request.release()

    def read(self, port: str) -> bool:
        """Whether a line is active. Raises DeviceError."""
        try:
            return bool(self._request.get_value(self._lines[port]) == self._gpiod.line.Value.ACTIVE)
        except OSError as error:
            raise self._gone(error) from None

    def write(self, port: str, value: bool) -> None:
        """Make a line active or not. Raises DeviceError."""
        values = self._gpiod.line.Value
        try:
            self._request.set_value(self._lines[port], values.ACTIVE if value else values.INACTIVE)
        except OSError as error:
            raise self._gone(error) from None

    def _gone(self, error: OSError) -> DeviceError:
        if error.errno == errno.ENODEV:
            return DeviceError("the chip was unplugged: connect it and start again")
        return DeviceError(error.strerror or str(error))


def found() -> list[str]:
    """The chips of this machine. Raises DeviceError if there is no permission for one."""
    for chip in _chips():
        if not os.access(chip, os.R_OK | os.W_OK):
            raise no_permission(chip, "gpio")
    gpiod = library("gpiod", "gpiod", "gpio")
    lines = []
    for chip in _chips():
        with gpiod.Chip(chip) as opened:
            information = opened.get_info()
            count = f"{information.num_lines} line{'s' * (information.num_lines != 1)}"
            lines.append(f"{chip}: {information.label}, {count}")
    return lines


def _chips() -> list[str]:
    return sorted(glob.glob("/dev/gpiochip*"))
