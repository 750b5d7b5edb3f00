"""What can be wrong with a body in another language."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record


@record
class UnsupportedLanguage(Diagnostic):
    """A body is written in a language that cannot be called.

    Bodies of submodels, processes and drivers may be written in Python, those of processes and submodels in C. Functional mock-up units
    (``fmu``) are not supported yet.

    Refused::

        submodel Joint fmu "joint.fmu" {
          in  voltage : double
          out angle   : double
        }

    Mended::

        submodel Joint python "joint.py:Joint" {
          in  voltage : double
          out angle   : double
        }
    """

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
        return 'write `python "module.py:Class"`' + ("" if self.kind == "driver" else ' or `c "file.c"`')


@record
class MalformedTarget(Diagnostic):
    """The text that names an external body is not of the form that its language wants.

    For Python it is a file or a module and a class, ``module.py:Class`` or ``package.module:Class``; for C a file, ``file.c``. Files are
    looked for beside the file that names them. The name of a module is written into the generated code, that of a C file into its makefiles:
    a module consists of names of Python with dots between them, the file of letters, digits, ``_``, ``.``, ``+`` and ``-``.

    Refused::

        submodel Joint python "joint.py" {
          in  voltage : double
          out angle   : double
        }

    Mended::

        submodel Joint python "joint.py:Joint" {
          in  voltage : double
          out angle   : double
        }
    """

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
    """A driver has no body.

    A driver is a device: what reads and writes it is a class in Python.

    Refused::

        driver Amplifier {
          in voltage : double
        }

    Mended::

        driver Amplifier python "amplifier.py:Amplifier" {
          in voltage : double
        }
    """

    code = "E0822"
    title = "a driver without a body"

    driver: str

    @property
    def message(self) -> str:
        return f"the driver `{self.driver}` has no body"

    @property
    def help(self) -> str:
        return f'name its class: `driver {self.driver} python "module.py:{self.driver}"`'


@record
class MixedBody(Diagnostic):
    """A definition has both an external body and one in the language.

    What is computed outside cannot be described here as well: only ports belong to an external definition.

    Refused::

        submodel Double python "double.py:Double" {
          in  x : double
          out y : double

          y = 2 * x
        }

    Mended::

        submodel Double {
          in  x : double
          out y : double

          y = 2 * x
        }
    """

    code = "E0823"
    title = "two bodies"

    definition: str

    @property
    def message(self) -> str:
        return f"`{self.definition}` has an external body, and so only ports, no equations or diagrams"
