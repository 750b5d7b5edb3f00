"""Names that mean something to C, to C++, to Python, or to the generators, in every role of a program: what is
generated compiles. ``python -m tests.codegen.names.test_nasty_names 1000`` tries more of them.
"""

from __future__ import annotations

import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product
from pathlib import Path

import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.codegen.c.package.linkage import NAMES
from cspdiag.codegen.c.text.names import _NETWORK_NAMES, FILES, identifier, library_name
from cspdiag.codegen.c.text.reserved import _KEYWORDS, _LIBRARY
from cspdiag.codegen.python.text.names import BUILTINS, KEYWORDS, MEMBERS, MODULES
from tests.codegen.packages import network, read
from tests.support.thorough import THOROUGH, in_turn

PROGRAM = """
const {constant} = 2.5
const {other_constant} = 3
enum {enum} {{ {enumerator}, {other_enumerator} }}
enum {other_enum} {{ {enumerator}, {third_enumerator} }}
struct {struct} {{ {field} : double  {other_field} : {enum}  {array} : int[2] }}
exception {exception}

submodel {law}({parameter} : double) {{
  in  {input} : double
  out {output} : double
  state {state} : double = 0
  let {let} = {parameter} * {input} - {state}
  {output} = {let} + {constant}
  next {state} = {output} / 2
}}

process {inner}({parameter} : int) {{
  in  {level} : double @ 2 ms
  in  {event} : {enum}
  out {drive} : double @ 2 ms
  out {lamp}  : {struct}
  communication {{
    var {variable} : double = 0
    var {other_variable} : {enum} = {enum}.{enumerator}
    var {held} : {struct} = {struct}({field} = 1, {other_field} = {enum}.{enumerator}, {array} = [1, {parameter}])
    {instance} : {law}({parameter} = 2)
    {level} -> {instance}.{input}
    {instance}.{output} -> {channel} : double
  }}
  composition {{
    (mu (
      {instance} ;
      (after 1 ms -> skip []
       {event} ? {other_variable} ->
       {held} := {struct}({field} = {held}.{field} + 1, {other_field} = {other_variable}, {array} = {held}.{array})) ;
      {variable} := {channel} + {held}.{field} ;
      if {held}.{other_field} == {enum}.{other_enumerator} and {held}.{array}[1] > {other_constant}
      then raise {exception} ;
      {drive} ! {variable} ; {lamp} ! {held}
    )) catch {exception} -> skip
  }}
}}

process {outer} {{
  in  {level} : double @ 2 ms
  in  {event} : {enum}
  in  {other_event} : {other_enum}
  out {drive} : double @ 2 ms safe 1
  out {lamp}  : {struct}
  out {direct} : {other_enum}
  communication {{
    {instance} : {inner}({parameter} = 7)
    {level} -> {instance}.{level}
    {event} -> {instance}.{event}
    {instance}.{drive} -> {drive}
    {instance}.{lamp} -> {lamp}
    var {variable} : {other_enum} = {other_enum}.{enumerator}
  }}
  composition {{
    {instance} || mu ({other_event} ? {variable} ; {direct} ! {variable})
  }}
}}

submodel {plant} {{
  in  {drive} : double
  in  {lamp}  : {struct}
  in  {direct} : {other_enum}
  out {level} : double
  out {event} : {enum}
  out {other_event} : {other_enum}
  state {state} : double = 0
  der {state} = ({drive} - {state}) / 1<s>
  {level} = {state} + {lamp}.{field} / 100
  {event} = if {level} > 1 then {enum}.{other_enumerator} else {enum}.{enumerator}
  {other_event} = if {level} > 2 then {other_enum}.{third_enumerator} else {direct}
}}

environment {environment} for {outer} step 1 ms {{
  {instance} : {plant}
  {instance}.{level} -> {level}
  {instance}.{event} -> {event}
  {instance}.{other_event} -> {other_event}
  {drive} -> {instance}.{drive}
  {lamp} -> {instance}.{lamp}
  {direct} -> {instance}.{direct}
}}
"""
ROLES = tuple(dict.fromkeys(re.findall(r"(?<!\{)\{(\w+)\}", PROGRAM)))
CPP = """
alignas alignof and and_eq asm bitand bitor catch char16_t char32_t class compl concept const_cast constexpr consteval
co_await decltype delete dynamic_cast explicit export final friend mutable namespace new noexcept not not_eq nullptr
operator or or_eq override private protected public reinterpret_cast requires static_assert static_cast template this
thread_local throw try typeid typename using virtual wchar_t xor xor_eq
"""
INTERFACE = """
memory instance input inputs output outputs hooks state begin advance continues next finish release stop save restore
describe api types build size_is_too_small SIZE API_H TYPES_H MORE BUDGET REFUSED ENDED FAILED DEADLOCK STOPPED
sample actuate lock unlock wake alive context real_time network network_names main constants
external present brought csp csp_read Csp CSP CSP_MS csp_config Network NetworkDrivers Memory Instance Hooks State
Inputs Input Double4 Double_4 IntT Int64 Int64T _x __x _X x_ X_t x__y E EOF I M_PI
INT64_MAX DBL_MAX HUGE_VAL errno assert isnan signbit linux unix i386 NAN
"""


@cache
def declared() -> frozenset[str]:
    """The macros, types and functions of the headers that generated code includes."""
    headers = "".join(f"#include <{name}.h>\n" for name in ("math", "string", "stdbool", "stddef", "stdint"))
    found: set[str] = set()
    for dialect in ("c99", "gnu11") if shutil.which("gcc") else ():
        for flags, pattern in (("-dM",), r"#define (\w+)"), (("-P",), r"\b(\w+)\s*[(;]"):
            command = ["gcc", f"-std={dialect}", "-E", *flags, "-"]
            found |= set(
                re.findall(
                    pattern, subprocess.run(command, input=headers, capture_output=True, text=True, check=True).stdout
                )
            )
    return frozenset(found)


@cache
def words() -> tuple[str, ...]:
    """Names of the languages and their libraries, and every word in generated packages and in the kernel."""
    texts = [CPP, INTERFACE, *KEYWORDS, *BUILTINS, *MEMBERS, *MODULES]
    for name in ("jiwy", "names", "emergency", "cascade"):
        for target in ("c", "python"):
            texts += [text for path, text in pipeline.generate(network(name), read, target).items() if path != NAMES]
    texts += [*declared(), *(_KEYWORDS | _LIBRARY)]
    return tuple(sorted({*re.findall(r"\b[A-Za-z_]\w*\b", "\n".join(texts))} - {"true", "false"}))


@cache
def own() -> tuple[str, ...]:
    """The words that are most likely to break something."""
    return tuple(sorted({*CPP.split(), *INTERFACE.split(), *_KEYWORDS, *FILES, *_NETWORK_NAMES} - {"true", "false"}))


def variants(word: str) -> tuple[str, ...]:
    camel = "".join(part.capitalize() for part in word.split("_"))
    return tuple(dict.fromkeys((word, word.lower(), word.upper(), word.capitalize(), camel)))


def programs(seed: int) -> Iterator[tuple[str, str]]:
    """Names of files and texts of programs, without end: in each, most roles have variants of a few words."""
    chance = random.Random(seed)
    plain = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)}
    while True:
        pool = words() if chance.random() < 0.5 else own()
        few = [choice for word in chance.sample(pool, chance.randint(4, 40)) for choice in variants(word)]
        names = {role: chance.choice(few) if chance.random() < 0.9 else plain[role] for role in ROLES}
        file = chance.choice([*few, "plant"])
        if chance.random() < 0.3:
            names[chance.choice(ROLES)] = f"{file}_{chance.choice(few)}"
        found = accepted(file, names, plain)
        if found is not None:
            yield file, found


def accepted(file: str, names: dict[str, str], plain: Mapping[str, str]) -> str | None:
    """The program, with other names where the language does not allow these."""
    for _ in range(60):
        text = PROGRAM.format(**names)
        built = pipeline.build(SourceFile(name=f"{file}.csp", text=text), read)
        if built.network is not None:
            return text
        places = [found.span.text for found in built.checked.report.diagnostics if found.severity == "error"]
        refused = [role for role, name in names.items() if any(name in re.findall(r"\w+", place) for place in places)]
        changed = [role for role in refused if names[role] != plain[role]] or [
            role for role in ROLES if names[role] != plain[role]
        ]
        if not changed:
            raise AssertionError(built.checked.report.diagnostics)
        names[changed[-1]] = plain[changed[-1]]
    return None


def complaints(file: str, text: str, level: int) -> str:
    """What compilers say of what is generated; nothing is expected."""
    built = pipeline.build(SourceFile(name=f"{file}.csp", text=text), read)
    assert built.network is not None
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for target in ("c", "python"):
            for path, content in pipeline.generate(built.network, read, target, level).items():
                (folder / target / path).parent.mkdir(parents=True, exist_ok=True)
                (folder / target / path).write_text(content)
        said = ""
        c = folder / "c"
        sources = [*c.glob("*.c")]
        header = c / f"{library_name(built.network.name)}_api.h"
        (c / "user.cpp").write_text(f'#include "{header.name}"\nint main() {{ return 0; }}\n')
        flags = ("-Wall", "-Wextra", "-Werror", f"-I{c}", f"-I{c / 'support'}", "-fsyntax-only")
        for command in (
            ["gcc", "-std=c99", "-Wpedantic", "-Wconversion", "-DCSP_TRACE=1", *flags, *sources],
            ["gcc", "-std=gnu11", *flags, *sources],
            ["g++", "-std=c++17", *flags, c / "user.cpp"],
            [sys.executable, "-m", "compileall", "-q", folder / "python"],
        ):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            said += done.stdout + done.stderr
        return said


def test_names_of_headers_are_changed() -> None:
    assert [name for name in declared() if identifier(name) == name] == []


def test_no_file_of_a_program_begins_like_those_of_the_kernel() -> None:
    """Which of these belong to a build is decided by their names."""
    names = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)}
    changed = {"law": "csp_port", "inner": "CspPortPosix"}
    text = PROGRAM.format(**names | changed)
    built = pipeline.build(SourceFile(name="csp_port_board.csp", text=text), read)
    assert built.network is not None
    files = {path for path in pipeline.generate(built.network, read, "c") if not path.startswith("support/")}
    assert {path for path in files if path.startswith("csp")} == {"csp_config.h"}
    assert {"xcsp_port.c", "xcsp_port_posix.c", "xcsp_port_board_api.h"} <= files


EVENTS = """
memory instance input inputs output outputs hooks begin advance continues finish release stop save restore
describe api types in_level IN_LEVEL SIZE size More level Level LEVEL class int top_inputs mode MODE mode_more
"""
INTERFACE_OF = """
struct TopInputs {{ x : bool }}
enum State {{ MORE, more, Stop }}
enum Mode {{ more }}
process Top {{
{ports}
  in  sampled : TopInputs @ 1 ms
  in  Sampled : double @ 1 ms
  out done : State
  out Done : Mode
  communication {{ var v : bool = false  var s : TopInputs = TopInputs(x = false)  var d : double = 0 }}
  composition {{ ({choices} [] sampled ? s -> skip [] Sampled ? d -> skip) ; done ! State.more ; Done ! Mode.more }}
}}
"""


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
def test_events_with_names_of_the_interface_have_functions_with_a_number() -> None:
    names = EVENTS.split()
    ports = "\n".join(f"  in {name} : bool" for name in names)
    text = INTERFACE_OF.format(ports=ports, choices=" [] ".join(f"{name} ? v -> skip" for name in names))
    assert complaints("top", text, 0) == ""
    built = pipeline.build(SourceFile(name="top.csp", text=text), read)
    assert built.network is not None
    header = pipeline.generate(built.network, read, "c")["top_api.h"]
    functions = re.findall(r"^bool (top_\w+)\(\s*top_instance \*self,\s*bool value\);", header, re.MULTILINE)
    assert len(functions) == len(names)
    assert {"top_stop_2", "top_begin_2", "top_level", "top_Level", "top_LEVEL", "top_class", "top_int"} <= {*functions}


@pytest.mark.parametrize(
    "file",
    ["csp", "CSP", "int", "network", "main", "types", "csp_core", "connect", "initialize"]
    + ["csp_event", "m", "safe", "write", "read", "poll", "attach", "set", "copy"] * THOROUGH,
)
@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
def test_programs_with_the_names_of_files_and_of_the_kernel(file: str) -> None:
    names = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)} | {
        "event": "begin",
        "other_event": "read",
    }
    assert complaints(file, PROGRAM.format(**names), 0) == ""


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("seed", range(2))
def test_no_name_breaks_what_is_generated(seed: int, level: int) -> None:
    file, text = next(programs(seed))
    assert complaints(file, text, level) == "", text


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
def test_ports_with_names_of_functions_of_their_class_and_of_the_network() -> None:
    names = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)} | {
        "inner": "Inner",
        "drive": "inner_initialize",
        "level": "NETWORK_FUNCTIONS",
        "lamp": "network_process_count",
        "field": "NETWORK_DEPTH",
    }
    assert complaints("connect", PROGRAM.format(**names), 0) == ""


HIDING = """
parameter {tuned} : double = 2.0
submodel Law({of_law} : double) {{
  in  x : double
  out y : double
  state s : double = 1
  let {let} = x * {of_law}
  y = {let} + s + {tuned}
  der s = x / 1<s>
}}
process Motor({of_process} : double) {{
  in  x : double @ 2 ms
  out y : double @ 2 ms
  communication {{ law : Law({of_law} = {of_process})  x -> law.x  law.y -> y }}
  composition {{ mu law }}
}}
process Top {{
  in  x : double @ 2 ms
  out y : double @ 2 ms
  communication {{ motor : Motor({of_process} = 1 + {tuned})  x -> motor.x  motor.y -> y }}
  composition {{ motor }}
}}
environment Bench for Top step 1 ms {{ plant : Law({of_law} = 0.5)  y -> plant.x  plant.y -> x }}
"""


@pytest.mark.parametrize(
    ("word", "way"),
    in_turn(
        ("class", "places", "step", "initialize", "reset", "calculate", "slopes", "integrate"),
        tuple(product(("top", "network"), (0, 1))),
    ),
)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_no_parameter_hides_a_function_of_its_class(word: str, way: tuple[str, int], tmp_path: Path) -> None:
    file, level = way
    names = {"tuned": f"motor_{word}", "of_law": f"law_{word}", "let": f"motor_law_{word}", "of_process": f"law_{word}"}
    path = tmp_path / f"{file}.csp"
    path.write_text(HIDING.format(**names))
    program = cspdiag.load(path)
    expected = program.run(until="20 ms", level="reference")
    assert (*program.run(until="20 ms", target="c", level=level)["y"],) == (*expected["y"],)


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("roles", [("level", "drive", "field", "let"), ("event", "lamp", "variable", "input")])
def test_names_of_macros_of_the_interface(roles: tuple[str, str, str, str], level: int) -> None:
    first, second, third, fourth = roles
    names = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)}
    changed = {first: "TANK_SIZE", second: "TANK_PROCESSES", third: "TANK_SIZE", fourth: "TANK_PROCESSES"}
    if third == "variable":
        changed[third] = "TANK_SIZE_"
    assert complaints("tank", PROGRAM.format(**(names | changed)), level) == ""


CONSTANTS = """
parameter qgain : double = {sum}
const qfollows = qgain + {sum}
submodel Qlaw(qk: double) {{
  in  qx : double
  out qy : double
  state qs : double = 1
  state qr : double = 2
  der qs = (qx - qs) / 1<s>
  der qr = (qs - qr + {sum}) / 1<s>
  qy = qr * qk + {sum}
}}
process Qinner(qn: double) {{
  in  qx : double @ 2 ms
  out qy : double @ 2 ms
  out qz : double
  communication {{
    qlaw : Qlaw(qk = qn)
    var qv : double = {sum}
    qx -> qlaw.qx
    qlaw.qy -> qy
  }}
  composition {{ (seq qi < 2 : (qz ! qv + {sum} + qfollows ; qv := qv + qn)) ; mu qlaw }}
}}
process Qouter {{
  in  qx : double @ 2 ms
  out qy : double @ 2 ms
  out qz : double
  communication {{
    qinner : Qinner(qn = {sum} + 1)
    qx -> qinner.qx
    qinner.qy -> qy
    qinner.qz -> qz
  }}
  composition {{ qinner }}
}}
environment Qbench for Qouter step 1 ms {{
  qplant : Qlaw(qk = {sum})
  qy -> qplant.qx
  qplant.qy -> qx
  qz -> _
}}
"""


def names_in_functions() -> Iterator[str]:
    """The names that generated functions have for something: parameters, variables, and all that looks like them."""
    for name in ("cascade", "emergency"):
        for target in ("c", "python"):
            for level in (0, 1):
                for path, text in pipeline.generate(network(name), read, target, level).items():
                    if path.endswith((".c", ".py")) and not {"support", "runtime"} & {*Path(path).parts}:
                        yield from re.findall(r"\b[A-Za-z_]\w*\b", text)


def allowed_as_constants(names: set[str]) -> list[str]:
    """Those that the language allows."""
    while True:
        text = "".join(f"const {name} = 1.0\n" for name in sorted(names)) + "process P { composition { skip } }\n"
        found = pipeline.check(SourceFile(name="names.csp", text=text), read).report.diagnostics
        refused = {text.splitlines()[entry.span.line - 1].split()[1] for entry in found if entry.severity == "error"}
        if not refused & names:
            return sorted(names)
        names -= refused


def test_constants_have_their_values_however_they_are_called(tmp_path: Path) -> None:
    """Whatever names functions have: a constant of this name is not hidden by them."""
    constants = allowed_as_constants({*names_in_functions(), "Parameter", "Parameters", "ProgramParameters"})
    assert {"h", "now", "name", "k1", "party", "progress", "slopes", "ProgramParameters"} <= {*constants}
    declarations = "".join(f"const {name} = {number}.0\n" for number, name in enumerate(constants, 1))
    parts = [" + ".join(constants[start : start + 40]) for start in range(0, len(constants), 40)]
    total = f"({' + '.join(f'({part})' for part in parts)}) / 1000000"
    file = tmp_path / "names.csp"
    file.write_text(declarations + CONSTANTS.format(sum=total))
    program = cspdiag.load(file)
    expected = program.run(until="6 ms", level="reference")
    for target in ("python", "c") if shutil.which("gcc") else ("python",):
        for level in (0, 1):
            run = program.run(until="6 ms", target=target, level=level)
            for port in ("qy", "qz"):
                assert (*run[port],) == (*expected[port],), (target, level, port)


def hunt(count: int, first: int) -> None:
    """Try this many programs, from a seed on, and print those that break something."""
    for seed in range(first, first + count):
        file, text = next(programs(seed))
        said = complaints(file, text, seed % 2)
        if said:
            print(f"==== {seed} {file}\n{said[:2000]}\n{text}", flush=True)


if __name__ == "__main__":
    hunt(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000)
