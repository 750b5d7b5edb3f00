"""Whether native programs can load the FMUs of an environment: binaries may need what only a Python process has."""

from __future__ import annotations

import re
import shlex
import subprocess

from cspdiag.codegen.c.laws.fmus import library_of
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.external import file_of_fmu, fmu_calls
from cspdiag.network.ir.network import Environment
from cspdiag.simulate.native.build import Build

_LOADER = """\
#include <dlfcn.h>
#include <stdio.h>

int main(int count, char *words[])
{
    if ((count == 2) && (dlopen(words[1], RTLD_NOW | RTLD_LOCAL) == NULL)) {
        (void)puts(dlerror());
        return 1;
    }
    return 0;
}
"""
"""Loads a binary as ``csp_fmu_library.c`` does, in a process without a Python."""

_OF_PYTHON = re.compile(r"symbol.*\b_*Py[A-Z_]")


def require_loadable(environment: Environment) -> None:
    """Raises TargetError, with the place, for the first FMU that a native program cannot load, and CompilerError."""
    for call in fmu_calls(environment):
        reason = _refusal(library_of(call))
        if reason:
            path, place = file_of_fmu(call.external), call.external.span
            if _OF_PYTHON.search(reason):
                raise TargetError(
                    f"{place}: {path} is a Python program, as FMUs of pythonfmu are, which a native program cannot "
                    f"call\n  help: run it in Python: leave out --target c"
                )
            raise TargetError(
                f"{place}: {path} cannot be loaded: {reason}\n  help: its binary is damaged, or needs a library that "
                f"is not here: export it again, or compile its sources, if it has some: fmpy compile "
                f"{shlex.quote(path)}"
            )


def _refusal(library: str) -> str:
    """Why a binary cannot be loaded; empty if it can, or if it ends the process, as it then does in a run."""
    program = Build({"load.c": _LOADER}, ["load.c"]).executable()
    done = subprocess.run([program, library], capture_output=True, text=True, errors="replace", check=False)
    return done.stdout.strip().removeprefix(f"{library}: ") if done.returncode == 1 else ""
