"""Inputs from a recording for a native program: its environment is replaced by one that reads them from a file."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from typing import IO, TYPE_CHECKING, Any

from cspdiag.simulate.native.values import numpy_type
from cspdiag.simulate.record.leaves import leaves

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.simulate.record.stored.inputs import RecordedInputs

VARIABLE = "CSP_RECORDED_INPUTS"
"""The environment variable with the name of the file."""

_HEAD = struct.Struct("=qII")
"""The instant, the position of the port among the external ports, the bytes of the value that follows."""

_SOURCE = """

/* Instead of what is computed above: inputs from a recording. */
#undef {name}
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const csp_environment {name};

typedef struct recorded_change {{
    int64_t time;
    uint32_t port;
    uint32_t size;
}} recorded_change;

static FILE *recorded_inputs;
static recorded_change upcoming;
static bool has_upcoming;

static void read_change(void)
{{
    has_upcoming = fread(&upcoming, sizeof upcoming, 1, recorded_inputs) == 1;
}}

static void *device_of_change(void)
{{
    return ((const csp_driver *)&{name}_drivers)[upcoming.port].device;
}}

static bool recorded_start(csp_kernel *csp, void *state)
{{
    static const bool is_event[] = {{{events}}};
    (void)csp;
    (void)state;
    const char *const path = getenv("{variable}");
    recorded_inputs = (path != NULL) ? fopen(path, "rb") : NULL;
    if (recorded_inputs == NULL) {{
        (void)fprintf(stderr, "{variable} names no file that can be read\\n");
        exit(3);
    }}
    read_change();
    while (has_upcoming && (upcoming.time < 0)) {{
        unsigned char *const device = device_of_change();
        has_upcoming = fread(device, upcoming.size, 1, recorded_inputs) == 1;
        if (is_event[upcoming.port]) {{
            (void)memcpy(device + upcoming.size, device, upcoming.size);
        }}
        read_change();
    }}
    return true;
}}

static bool recorded_advance(csp_kernel *csp, void *state, int64_t now)
{{
    (void)csp;
    (void)state;
    while (has_upcoming && (upcoming.time <= now)) {{
        has_upcoming = fread(device_of_change(), upcoming.size, 1, recorded_inputs) == 1;
        read_change();
    }}
    return true;
}}

const csp_environment {name} = {{INT64_C({step}), recorded_start, recorded_advance, NULL, NULL}};
"""


def with_recorded_inputs(files: Mapping[str, str], environment: str, inputs: RecordedInputs) -> dict[str, str]:
    """The files of a package in which an environment gives recorded inputs."""
    main = next(text for path, text in files.items() if path.endswith("main_simulation.c"))
    scenario = re.search(rf'{{"{re.escape(environment)}", &(\w+),', main)
    assert scenario is not None
    name = scenario[1]
    path, text = next((path, text) for path, text in files.items() if f"const csp_environment {name} =" in text)
    places = dict(zip(inputs.positions, inputs.ports, strict=True))
    events = ", ".join(
        "true" if at in places and places[at].sampling is None else "false" for at in range(max(places, default=0) + 1)
    )
    added = _SOURCE.format(name=name, variable=VARIABLE, events=events, step=inputs.step)
    return {**files, path: f"#define {name} {name}_computed\n{text}{added}"}


def write_inputs(inputs: RecordedInputs, file: IO[bytes]) -> None:
    """The file that it reads."""
    encoders = [_Encoder(port.type) for port in inputs.ports]
    for at, value in enumerate(inputs.initial):
        file.write(encoders[at].encoded(-1, inputs.positions[at], value))
    for time, at, value in inputs.changes():
        file.write(encoders[at].encoded(time, inputs.positions[at], value))


class _Encoder:
    """Encodes values of a type as C programs on this machine have them in memory."""

    def __init__(self, kind: Type) -> None:

        self._paths = [path for _, _, path in leaves("", kind)]
        self._type = numpy_type(kind)

    def encoded(self, time: int, port: int, value: Any) -> bytes:
        """A change, with its value."""
        import numpy

        into = numpy.zeros(1, self._type)
        for path in self._paths:
            place: Any = into
            part = value
            for index in path:
                part = part[index]
                place = place[:, index] if place.ndim > 1 else place[(place.dtype.names or ())[index]]
            place[...] = part
        data = into.tobytes()
        return _HEAD.pack(time, port, len(data)) + data
