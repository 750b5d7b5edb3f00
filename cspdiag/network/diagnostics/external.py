"""What can be wrong with a body in another language."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record


@record
class UnsupportedLanguage(Diagnostic):
    code = "E0820"
    title = "a body that cannot be called"

    language: str
    kind: str

    @property
    def message(self) -> str:
        if self.language == "fmu":
            return "functional mock-up units are not supported yet"
        return f"the body of a {self.kind} cannot be written in `{self.language}`"

    @property
    def help(self) -> str:
        if self.language == "fmu":
            return 'wrap it in a Python class, for example with FMPy: `python "joint.py:Joint"`'
        return 'write `python "module.py:Class"`' + (
            ', `c "file.c"` or `device "NAME"`' if self.kind == "driver" else ' or `c "file.c"`'
        )


@record
class MalformedTarget(Diagnostic):
    code = "E0821"
    title = "a malformed name of a body"

    language: str
    target: str

    @property
    def message(self) -> str:
        return f'"{self.target}" does not name a body in {self.language.capitalize()}'

    @property
    def help(self) -> str:
        if self.language == "c":
            return 'write `c "file.c"`, with letters, digits, `_`, `.`, `+` and `-` in the name of the file'
        return 'write `python "module.py:Class"`'


@record
class DriverWithoutBody(Diagnostic):
    code = "E0822"
    title = "a driver without a body"

    driver: str

    @property
    def message(self) -> str:
        return f"the driver `{self.driver}` has no body"

    @property
    def help(self) -> str:
        class_ = f'`driver {self.driver} python "module.py:{self.driver}"`'
        return f'name its class, its source in C or a device: {class_}, `c "file.c"`, `device "udp"`'


@record
class MixedBody(Diagnostic):
    code = "E0823"
    title = "two bodies"

    definition: str

    @property
    def message(self) -> str:
        return f"`{self.definition}` has an external body, and so only ports, no equations or diagrams"
