"""Control laws and processes written by hand in C must have the types of their ports; otherwise a message says what is
wrong.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native import run as native
from cspdiag.simulate.native.build import CompilerError
from tests.c_kernel.building import STRICT
from tests.codegen.c.by_hand.test_leaves import HEADER, NEEDS_COMPILER, SOURCE
from tests.codegen.c.test_package import COMPILERS, written

MS = 1_000_000

PROGRAM = """
submodel Valve(gain: double) c "valve.c" {
  in  level   : double
  in  count   : int
  out opening : double
}

submodel Doubled {
  in  level   : double
  out opening : double

  valve : Valve(gain = 1)
  valve.level = level
  valve.count = 2
  opening = 2 * valve.opening
}

process Tank {
  in  level   : double @ 10 ms
  out opening : double @ 10 ms

  communication {
    valve : VALVE
    level         -> valve.level
    valve.opening -> opening
    COUNT
  }

  composition {
    mu valve
  }
}
"""

ENVIRONMENT = """
submodel World { in opening : double  out level : double  level = 1 }
environment Bench for Tank step 1 ms {
  world : World
  opening     -> world.opening
  world.level -> level
}
"""

LAW = """
#ifndef VALVE_H
#define VALVE_H
#include <stdint.h>
struct valve { MEMBERS double gain; };
void valve_initialize(struct valve *self, double gain);
void valve_reset(struct valve *self);
void valve_calculate(struct valve *self);
#endif
"""


def network_of(text: str, folder: Path) -> CoreNetwork:
    built = pipeline.build(SourceFile(name=str(folder / "tank.csp"), text=text), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return built.network


def compiled(folder: Path, compiler: str, members: str, header: str = LAW, *, nested: bool) -> str:
    """What a compiler says of the package, with these members in the hand-written header."""
    (folder / "valve.c").write_text('#include "valve.h"\n')
    (folder / "valve.h").write_text(header.replace("MEMBERS", members))
    law, count = ("Doubled", "") if nested else ("Valve(gain = 2)", "var n : int = 1  n -> valve.count")
    network = network_of(PROGRAM.replace("VALVE", law).replace("COUNT", count), folder)
    return syntax_errors(compiler, written(pipeline.generate(network, read_source, "c"), folder / "package"))


def syntax_errors(compiler: str, package: Path) -> str:
    """What a compiler says of the sources of a package."""
    sources = [str(path) for path in package.glob("*.c") if path.name != "main_simulation.c"]
    flags = [compiler, *STRICT, "-std=c99", "-fsyntax-only", f"-I{package}", f"-I{package / 'support'}"]
    return subprocess.run([*flags, *sources], capture_output=True, text=True, check=False).stderr


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("nested", [False, True])
def test_members_of_a_law_have_the_types_of_its_ports(compiler: str, nested: bool, tmp_path: Path) -> None:
    assert compiled(tmp_path, compiler, "double level; int64_t count; double opening;", nested=nested) == ""


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("nested", [False, True])
@pytest.mark.parametrize(
    ("members", "member", "type_"),
    [
        ("float level; int64_t count; double opening;", "level", "double"),
        ("double level; double count; double opening;", "count", "int64_t"),
        ("double level; int64_t count; float opening;", "opening", "double"),
        ("double level; int32_t count; double opening;", "count", "int64_t"),
    ],
)
def test_other_types_are_refused_with_a_reason(
    compiler: str, nested: bool, members: str, member: str, type_: str, tmp_path: Path
) -> None:
    reported = compiled(tmp_path, compiler, members, nested=nested)
    assert (
        f"valve.h: the member `{member}` of `struct valve` has to be `{type_}`, as the port is (tank.csp:" in reported
    )


@pytest.mark.parametrize("nested", [False, True])
def test_a_missing_member_is_refused_with_a_reason(nested: bool, tmp_path: Path) -> None:
    with pytest.raises(TargetError, match="`struct valve` has no member `count` for the port `count`") as refused:
        compiled(tmp_path, "cc", "double level; /* int64_t count; */ double opening;", nested=nested)
    assert str(refused.value).startswith("valve.h: ")
    assert "(tank.csp:" in str(refused.value)


DRIVEN = """
driver Board c "board.c" { in open : double }
process Main { out y : double @ 10 ms  composition { mu (y ! 1.0 ; wait 10 ms) } }
environment Bench for Main {
  board : Board
  y -> board.open
}
"""

BOARD = """
#include <stdbool.h>
struct board { double MEMBER; };
bool board_open(struct board *self);
void board_close(struct board *self);
void board_write_open(struct board *self);
"""


def test_a_missing_member_of_a_driver_is_refused_with_its_name_in_c(tmp_path: Path) -> None:
    (tmp_path / "board.c").write_text('#include "board.h"\n')
    (tmp_path / "board.h").write_text(BOARD.replace("MEMBER", "open"))
    network = network_of(DRIVEN, tmp_path)
    with pytest.raises(TargetError, match=r"board\.h: `struct board` has no member `open_` for the port `open`"):
        pipeline.generate(network, read_source, "c")
    (tmp_path / "board.h").write_text(BOARD.replace("MEMBER", "open_"))
    assert pipeline.generate(network_of(DRIVEN, tmp_path), read_source, "c")


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("nested", [False, True])
@pytest.mark.parametrize("parameters", ["float gain", "double gain, double other", "void"])
def test_other_parameters_are_refused_with_a_reason(
    compiler: str, nested: bool, parameters: str, tmp_path: Path
) -> None:
    """C would convert an argument silently to what the parameter is."""
    law = LAW.replace("struct valve *self, double gain", parameters.replace("float", "struct valve *self, float"))
    reported = compiled(tmp_path, compiler, "double level; int64_t count; double opening;", law, nested=nested)
    expected = "void valve_initialize(struct valve *, double)"
    assert f"valve.h: `valve_initialize` has to be `{expected}`, as its definition is (tank.csp:2)" in reported


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("nested", [False, True])
@pytest.mark.parametrize(
    "calculating", ["int valve_calculate(struct valve *self)", "void valve_calculate(struct valve *self, int again)"]
)
def test_another_function_that_calculates_is_refused(
    compiler: str, nested: bool, calculating: str, tmp_path: Path
) -> None:
    law = LAW.replace("void valve_calculate(struct valve *self)", calculating)
    reported = compiled(tmp_path, compiler, "double level; int64_t count; double opening;", law, nested=nested)
    assert "valve.h: `valve_calculate` has to be `void valve_calculate(struct valve *)`" in reported


@NEEDS_COMPILER
@pytest.mark.parametrize("parameters", ["struct valve *self", "struct valve *self, const double *gain"])
def test_a_run_reports_the_reason_before_the_messages_of_calls(parameters: str, tmp_path: Path) -> None:
    (tmp_path / "valve.c").write_text('#include "valve.h"\n')
    law = LAW.replace("struct valve *self, double gain", parameters)
    (tmp_path / "valve.h").write_text(law.replace("MEMBERS", "double level; int64_t count; double opening;"))
    law, count = "Valve(gain = 2)", "var n : int = 1  n -> valve.count"
    network = network_of(PROGRAM.replace("VALVE", law).replace("COUNT", count) + ENVIRONMENT, tmp_path)
    with pytest.raises(CompilerError) as found:
        native.simulate(network, read_source, until=10 * MS, options=("-O0",))
    reason = "valve.h: `valve_initialize` has to be `void valve_initialize(struct valve *, double)`"
    assert reason in str(found.value).split("error", 2)[1]


@NEEDS_COMPILER
@pytest.mark.parametrize("flags", [["-std=c11", "-U__GNUC__"], ["-std=c99", "-U__GNUC__"]])
def test_other_compilers_find_it_too(flags: list[str], tmp_path: Path) -> None:
    """Compilers without the GNU extensions: checks by C11, or by the sizes."""
    source = tmp_path / "law.c"
    body = (
        'struct law {{ {type} level; }};\nCSP_REQUIRE_MEMBER(struct law, level, double, level_must_be_double, "no");\n'
    )
    support = Path(__file__).parents[4] / "templates" / "c" / "support"
    for type_, expected in (("double", 0), ("float", 1)):
        source.write_text('#include "csp_by_hand.h"\n' + body.format(type=type_))
        command = [COMPILERS[0], *flags, f"-I{support}", "-fsyntax-only", str(source)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == expected, done.stderr


@NEEDS_COMPILER
def test_a_variable_of_another_size_is_a_fault_of_a_process_by_hand(tmp_path: Path) -> None:
    (tmp_path / "scale.c").write_text(SOURCE)
    (tmp_path / "scale.h").write_text(
        HEADER.replace("int64_t gain, value, other", "int64_t gain, other; int32_t value")
    )
    text = """
process Scale(gain: int) c "scale.c" { in input : int  in offset : int = 7  out output : int }
process Top {
  in  level : int @ 1 ms
  out shown : int
  communication {
    scale : Scale(gain = 3)
    level        -> scale.input
    scale.output -> shown
  }
  composition { scale }
}
submodel World { in shown : int  out level : int  level = 5 }
environment Bench for Top step 1 ms {
  world : World
  shown       -> world.shown
  world.level -> level
}
"""
    run = native.simulate(network_of(text, tmp_path), read_source, until=10 * MS, options=("-O0",))
    assert run.outcome.ended == "failed"
    assert "a variable of 4 bytes for values of 8" in str(run.outcome.error)


NOT_FINITE = """
struct Pair { a : double  b : int }
submodel Law() c "law.c" {
  in  x : double
  out y : double
  out pair : Pair
}
process Top {
  in  x : double @ 10 ms
  out z : double @ 10 ms
  communication {
    law : Law
    var y : double = 0
    var pair : Pair = Pair(a = 0, b = 0)
    x        -> law.x
    law.y    -> y
    law.pair -> pair
  }
  composition { mu (law ; z ! 1) }
}
submodel Plant {
  in  z : double
  out x : double
  x = 1
}
environment Bench for Top {
  plant : Plant
  z       -> plant.z
  plant.x -> x
}
"""
CALCULATES = """
#include "law.h"
void law_initialize(struct law *self) { law_reset(self); }
void law_reset(struct law *self) { self->y = 0.0; }
void law_calculate(struct law *self) { self->MEMBER = (self->x - self->x) / (self->x - self->x); }
"""


@NEEDS_COMPILER
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("member", ["y", "pair.a"])
def test_a_law_that_calculates_no_number_faults(member: str, level: int, tmp_path: Path) -> None:
    """Also if only variables take its outputs."""
    (tmp_path / "law.h").write_text(
        "#ifndef LAW_H\n#define LAW_H\n"
        '#include "types.h"\n'
        "struct law { double x; double y; struct tank_pair pair; };\n"
        "void law_initialize(struct law *self);\nvoid law_reset(struct law *self);\n"
        "void law_calculate(struct law *self);\n"
        "#endif\n"
    )
    (tmp_path / "law.c").write_text(CALCULATES.replace("MEMBER", member))
    network = network_of(NOT_FINITE, tmp_path)
    run = native.simulate(network, read_source, level=level, until=50 * MS, options=("-O0",))
    assert run.outcome.ended == "failed"
    assert str(run.outcome.error) == "a real value is infinite or not a number, in Top.law (tank.csp:3)"


ENUMERATION = """
enum Mode { off, on }
struct Held { mode : Mode  level : int }
submodel Law c "law.c" {
  in  x     : double
  out mode  : Mode
  out modes : Mode[2]
  out held  : Held
}
submodel Whole {
  in  x    : double
  out mode : Mode
  law : Law
  law.x = x
  mode = if law.held.mode == Mode.on then law.modes[1] else law.mode
}
process Top {
  in  x : double @ 10 ms
  out z : Mode @ 10 ms safe Mode.off
  communication {
    law : LAW
    x        -> law.x
    law.mode -> z
    OTHERS
  }
  composition { mu law }
}
submodel Plant {
  out x : double
  x = 1
}
submodel Beside {
  out x : double
  law : Law
  law.x = 1
  x = if law.mode == Mode.on then 1 else 2
}
environment Bench for Top {
  plant : PLANT
  z -> _
  plant.x -> x
}
"""
COUNTS = """
#include "law.h"
void law_initialize(struct law *self) { law_reset(self); }
void law_reset(struct law *self)
{
    self->mode = TANK_MODE_OFF; self->modes.at[0] = TANK_MODE_ON; self->modes.at[1] = TANK_MODE_ON;
    self->held.mode = TANK_MODE_OFF; self->held.level = 7;
}
void law_calculate(struct law *self) { self->MEMBER = (enum tank_mode)(self->x > 0.5 ? 7 : 0); }
"""


@NEEDS_COMPILER
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("member", ["mode", "modes.at[1]", "held.mode"])
@pytest.mark.parametrize(("law", "plant"), [("Law", "Plant"), ("Whole", "Plant"), ("", "Beside")])
def test_a_law_that_calculates_no_value_of_an_enumeration_faults(
    law: str, plant: str, member: str, level: int, tmp_path: Path
) -> None:
    others = "law.modes -> _\n    law.held -> _" if law == "Law" else ""
    text = ENUMERATION.replace("LAW", law).replace("PLANT", plant).replace("OTHERS", others)
    if not law:
        text = text.replace("    x        -> law.x\n    law.mode -> z\n", "")
        text = text.replace("mu law", "mu (x ? read ; z ! Mode.on)").replace("    law : \n", "    var read : double\n")
    (tmp_path / "law.h").write_text(
        "#ifndef LAW_H\n#define LAW_H\n"
        '#include "types.h"\n'
        "struct law { double x; enum tank_mode mode; struct tank_mode_2 modes; struct tank_held held; };\n"
        "void law_initialize(struct law *self);\nvoid law_reset(struct law *self);\n"
        "void law_calculate(struct law *self);\n"
        "#endif\n"
    )
    (tmp_path / "law.c").write_text(COUNTS.replace("MEMBER", member))
    network = network_of(text, tmp_path)
    run = native.simulate(network, read_source, level=level, until=50 * MS, options=("-O0",))
    assert run.outcome.ended == "failed"
    assert "7 is no value of Mode, in " in str(run.outcome.error)


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
def test_headers_beside_a_law_are_copied_with_it(compiler: str, tmp_path: Path) -> None:
    (tmp_path / "filter.h").write_text('#pragma once\n#include "real.h"\nstruct filter { real *now, taps[TAPS]; };\n')
    (tmp_path / "real.h").write_text("#pragma once\n#define TAPS 12\ntypedef double real;\n")
    (tmp_path / "unused.h").write_text("#error this is of another program\n")
    header = LAW.replace("#include <stdint.h>", '#include <stdint.h>\n#include "filter.h"')
    members = "real level, opening; int64_t count; struct filter filter;"
    assert compiled(tmp_path, compiler, members, header, nested=False) == ""
    package = tmp_path / "package"
    assert (package / "real.h").exists()
    assert not (package / "unused.h").exists()
    assert "struct valve, filter)" in (package / "network_pointers.c").read_text()


@pytest.mark.parametrize("name", ["valve.h", "filter.h"])
def test_headers_without_a_guard_are_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "filter.h").write_text(
        "#pragma once\n" if name == "valve.h" else "/* none */ struct filter { int a; };\n"
    )
    header = LAW.replace("#ifndef VALVE_H\n#define VALVE_H", '#include "filter.h"').replace("#endif", "")
    if name == "filter.h":
        header = LAW.replace("#include <stdint.h>", '#include "filter.h"')
    with pytest.raises(TargetError, match=f"{name} has no include guard") as refused:
        compiled(tmp_path, "cc", "double level, opening; int64_t count;", header, nested=False)
    assert f"#ifndef {name.replace('.', '_').upper()}" in str(refused.value)


@pytest.mark.parametrize(
    ("includes", "members", "reason"),
    [
        ('#include "../common.h"', "", "common.h, which is in another folder"),
        ("", "fir_instance fir;", "valve.h:6: `fir_instance`, the type of `fir`, is not defined here"),
        ("", "struct fir fir[3];", "valve.h:6: `struct fir`, the type of `fir`, is not defined here"),
        ("", '\n#include "fields.inc"\n', 'valve.h:7: `#include "fields.inc"` in `struct valve`'),
        ('#include "csp.h"', "", "csp.h, written by hand, has the name of a file of the kernel"),
    ],
    ids=["folder", "type", "struct", "members", "kernel"],
)
def test_what_is_not_known_of_a_law_is_refused(includes: str, members: str, reason: str, tmp_path: Path) -> None:
    folder = tmp_path / "program"
    folder.mkdir()
    for name in ("../common.h", "fields.inc", "csp.h"):
        (folder / name).write_text("#pragma once\n")
    header = LAW.replace("#include <stdint.h>", f"#include <stdint.h>\n{includes}")
    members = f"double level, opening; int64_t count; {members}"
    with pytest.raises(TargetError) as refused:
        compiled(folder, "cc", members, header, nested=False)
    assert reason in str(refused.value)


def test_types_of_the_c_library_and_pointers_are_known(tmp_path: Path) -> None:
    members = "double level, opening; int64_t count; time_t since; uint_fast16_t fast; FILE *log; struct tm *date;"
    header = LAW.replace("#include <stdint.h>", "#include <stdint.h>\n#include <stdio.h>\n#include <time.h>")
    assert compiled(tmp_path, "cc", members, header.replace('"valve.h"', '"./valve.h"'), nested=False) == ""


@NEEDS_COMPILER
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("nested", [False, True])
def test_a_header_without_includes_is_read_with_the_names_of_the_package(
    compiler: str, nested: bool, tmp_path: Path
) -> None:
    """What is included before it gives its functions the names that they have to the linker."""
    header = LAW.replace("#include <stdint.h>\n", "").replace("MEMBERS", "double level, opening;")
    (tmp_path / "valve.h").write_text(header)
    (tmp_path / "valve.c").write_text(
        """#include "valve.h"
void valve_initialize(struct valve *self, double gain) { self->gain = gain; }
void valve_reset(struct valve *self) { (void)self; }
void valve_calculate(struct valve *self) { self->opening = self->gain * self->level; }
"""
    )
    text = PROGRAM.replace("  in  count   : int\n", "").replace("  valve.count = 2\n", "").replace("COUNT", "")
    network = network_of(text.replace("VALVE", "Doubled" if nested else "Valve(gain = 2)"), tmp_path)
    assert syntax_errors(compiler, written(pipeline.generate(network, read_source, "c"), tmp_path / "package")) == ""
