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
        return f"the body of a {self.kind} cannot be written in `{self.language}`"

    @property
    def help(self) -> str:
        if self.language == "fmu":
            return "name an FMU in a submodel, and use that in an environment"
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
        if self.language == "fmu":
            return f'"{self.target}" does not name an FMU'
        return f'"{self.target}" does not name a body in {self.language.capitalize()}'

    @property
    def help(self) -> str:
        if self.language == "fmu":
            return 'write `fmu "file.fmu"`, or `fmu "file.fmu:ModelExchange"` for one of its interfaces'
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


@record
class UnusableFmu(Diagnostic):
    code = "E0840"
    title = "an FMU that cannot be used"

    problem: str
    advice: str

    @property
    def message(self) -> str:
        return self.problem

    @property
    def help(self) -> str:
        return self.advice


@record
class FmuInProcess(Diagnostic):
    code = "E0841"
    title = "an FMU in a process"

    submodel: str
    process: str

    @property
    def message(self) -> str:
        return f"`{self.submodel}` is an FMU, and a part of the process `{self.process}`"

    @property
    def help(self) -> str:
        return (
            "FMUs are parts of environments: they are models of plants, and programs run without the tools behind them"
        )
