"""All state of a program is in the memory that its owner gives: there may be several instances."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.cli.main import main
from cspdiag.cli.verbs.verify_timing import measured_times
from tests.c_kernel.building import HERE, STRICT, need, need_sanitizers, run
from tests.conformance.sources import network_of, read
from tests.support.compiling import compile_once

ROOT = Path(__file__).parents[2]
PLATFORM = "csp_platform"
"""What belongs to the process of the operating system, or to the machine: which run its handlers stop."""
HOSTED = (
    "main_", "csp_linear", "csp_port_", "csp_signals", "csp_simulation", "csp_steering", "csp_stream", "csp_tuning",
    "csp_watch",
)  # fmt: skip
PROGRAMS = ("models/jiwy/jiwy.csp", "models/dining/dining.csp", "tests/c_kernel/devices/machine.csp")


def package(folder: Path, program: str, level: int) -> Sequence[Path]:
    """The sources of a program and of the kernel, without what belongs to simulations and platforms."""
    for path, text in pipeline.generate(network_of(read(program)), read, "c", level).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    names = sorted(folder.rglob("*.c"))
    return [file for file in names if not file.name.startswith(HOSTED) and "_environment" not in file.name]


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("program", PROGRAMS)
def test_no_object_has_writable_data(program: str, level: int, tmp_path: Path) -> None:
    need("gcc", "nm")
    sources = [path for path in package(tmp_path, program, level) if path.stem != PLATFORM]
    objects = tmp_path / "objects"
    objects.mkdir()
    # Without -fno-pie, tables of constant addresses are relocated at the start and so listed as data.
    includes = (f"-I{tmp_path}", f"-I{tmp_path / 'support'}")
    compile_once("gcc", "-std=c99", "-O1", "-fno-pie", *includes, "-c", *sources, cwd=objects)
    symbols = [line.split() for line in run("nm", "-A", "-P", *sorted(objects.glob("*.o"))).splitlines()]
    assert len(symbols) > 100
    assert [symbol[:3] for symbol in symbols if symbol[2] in "bBdDC"] == []


def by_the_interface(folder: Path, program: str, main: Path, compiler: str, *options: str) -> Path:
    """A program with a main that uses nothing but its step interface, without platform and runs."""
    sources = [path for path in package(folder, program, 1) if path.stem not in (PLATFORM, "csp_run")]
    flags = (*STRICT, "-Wshadow", "-Wcast-qual", "-D_POSIX_C_SOURCE=200809L", "-g", *options)
    includes = (f"-I{folder}", f"-I{folder / 'support'}")
    compile_once(compiler, *flags, *includes, *sources, main, "-lm", "-pthread", "-o", folder / "program")
    return folder / "program"


@pytest.fixture(scope="module", params=["gcc", "clang"])
def machine(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The machine, by its step interface, with sanitizers."""
    need_sanitizers(request.param, "address,undefined")
    checked = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    folder = tmp_path_factory.mktemp("machine")
    main = HERE / "devices" / "interface.c"
    return by_the_interface(folder, "tests/c_kernel/devices/machine.csp", main, request.param, *checked)


MORE, BUDGET, REFUSED, ENDED, FAILED, DEADLOCK, STOPPED = range(7)


def test_what_cannot_begin_is_refused_with_a_reason(machine: Path) -> None:
    assert run(machine, "refuse").splitlines() == [
        "1 the hook `sample` is missing",
        "1 the hook `actuate` is missing",
        "1 the hook `lock` or `unlock` is missing",
        "1 the hook `lock` or `unlock` is missing",
        "1 the memory is too small: machine_memory is large enough",
        "1 the memory is misaligned: machine_memory has the alignment",
        "1 there is no memory",
        "1 there are no hooks",
        "nothing done 1",
        "0 ",
    ]


def test_a_run_in_steps(machine: Path) -> None:
    assert run(machine, "run").splitlines() == [
        "next 0",
        f"state {MORE}: running; driven 4, last 4, released 0, afterwards 0",
        f"next 12, backwards {REFUSED}, beyond the end {REFUSED}",
        f"budget {BUDGET}",
        "overwritten 0 1, wakes 2, waiting 1",
        f"state {ENDED}: ended by itself; driven 6, last -1, released 2, afterwards 0",
        f"lamp 0, alive 1, again {ENDED}, next 1",
        f"after finish {ENDED}, released 2",
        "begun: running, in the end: finished",
    ]


def test_a_reset_and_a_release_hand_over_safe_values(machine: Path) -> None:
    assert run(machine, "reset").splitlines() == [
        "released by the reset 2",
        "next 8 ms, after the stop 6 ms",
        f"state {STOPPED}: stopped; driven 2, last -1, released 2, afterwards 0",
        f"state {STOPPED}: stopped; driven 4, last -1, released 2, afterwards 0",
    ]


def test_who_is_late_misses_samples_in_real_time_only(machine: Path) -> None:
    late, at_leisure = run(machine, "late").splitlines()
    missed = "Timeout: a sample of Machine.level was overwritten before it had been taken, in Machine (machine.csp:14)"
    assert late == f"state {FAILED}: {missed}; driven 1, last -1, released 2, afterwards 0"
    assert at_leisure == f"state {MORE}: running; driven 5, last 4, released 0, afterwards 0"


def test_the_work_after_lateness_does_not_grow_with_it(machine: Path) -> None:
    late, samples = run(machine, "very late").splitlines()
    assert late.startswith(f"state {FAILED}: Timeout: a sample of Machine.level was overwritten")
    assert samples == "samples 2"


def test_a_driver_without_samples_and_with_a_nan(machine: Path) -> None:
    silent, nan, short, finished = run(machine, "bad").splitlines()
    assert silent == f"state {MORE}: running; driven 2, last 2, released 0, afterwards 0"
    fault = "Fault: nan is written to Machine.drive, in Machine (machine.csp:14)"
    assert nan == f"state {FAILED}: {fault}; driven 2, last -1, released 2, afterwards 0"
    assert short == ",,F,Fa,Fau,Faul,Fault,Fault:,Fault: ,Fault: n"
    assert finished == f"after finish {FAILED}"


def test_a_restored_run_continues_as_the_saved_one(machine: Path) -> None:
    restored, other, accepted, ended, same, refusals = run(machine, "restore").splitlines()
    assert restored == other == f"state {MORE}: running; driven 79, last 79, released 0, afterwards 0"
    assert accepted == "of another instance 1"
    assert ended == same
    assert ended.startswith(f"state {ENDED}")
    assert refusals == "damaged 0, of another build 0, of no instance 0"


def test_another_process_continues_from_a_copy(machine: Path) -> None:
    copies = [subprocess.run([machine, "keep"], stdout=subprocess.PIPE, check=True).stdout for _ in range(2)]
    assert copies[0] == copies[1]
    command = [machine, "resume"]
    shown = subprocess.run(command, input=copies[0], stdout=subprocess.PIPE, check=True, timeout=60).stdout.decode()
    failed, restored, running, ended, over = shown.splitlines()
    assert failed.startswith(f"state {FAILED}: Timeout")
    assert restored == "whole 1, restored 1, next 52"
    assert running == f"state {MORE}: running; driven 5, last 4, released 0, afterwards 0"
    assert ended.startswith(f"state {ENDED}: ended by itself; driven 5, last -1, released 2")
    assert over == f"of a run that has ended 1, released 2, state {ENDED}"


def test_events_can_be_polled_and_outputs_handed_over_before_samples_are_taken(machine: Path) -> None:
    assert run(machine, "exchange").splitlines() == [
        f"3 ms: state {MORE}, samples 1, drive 0, polls 0",
        f"6 ms: state {MORE}, samples 2, drive 2, polls 1",
        f"9 ms: state {MORE}, samples 4, drive 3, polls 2",
        "too early: drive 3",
        f"state {ENDED}, lamp 0",
        f"state {ENDED}: ended by itself; driven 3, last -1, released 2, afterwards 0",
    ]


def test_the_longest_times_are_those_that_the_timing_analysis_reads(tmp_path: Path) -> None:
    """A step lasts one reading of the counter; an instant some more, in as many parts as it is executed, and what is
    left of it without its steps is the time of the kernel.
    """
    need("gcc")
    main = HERE / "devices" / "interface.c"
    program = by_the_interface(tmp_path, "tests/c_kernel/devices/machine.csp", main, "gcc", "-DCSP_MEASURE=1")
    shown = subprocess.run([program, "measure"], capture_output=True, text=True, check=True, timeout=60)
    assert shown.stderr == "instant 60\n"
    (tmp_path / "times.json").write_text(shown.stdout)
    found = measured_times(str(tmp_path / "times.json"))
    assert [(step.path, step.longest, step.what) for step in found.steps] == [("Machine", 10_000, "thread")]
    assert found.kernel == 40_000


def test_refused_parameters_say_why_without_a_text(tmp_path: Path) -> None:
    """The numbers are those of the enums: the first parameter is not finite, the third constant cannot be computed."""
    need("gcc")
    program = by_the_interface(tmp_path, "tests/c_kernel/devices/tuned.csp", HERE / "devices" / "tuned.c", "gcc")
    done, not_finite, not_computed, again = run(program).splitlines()
    assert done == "done 1, refusal 0, parameter 0; driven 28"
    assert not_finite == "done 0, refusal 1, parameter 0; driven 28"
    assert not_computed == "done 0, refusal 2, parameter 2; driven 28"
    assert again.startswith("done 1, refusal 0")
    assert again.endswith("driven 23")
    header = (tmp_path / "tuned_api.h").read_text()
    assert "TUNED_PARAMETER_GAINS,\n    TUNED_PARAMETER_COUNT,\n    TUNED_PARAMETER_SHARE\n" in header


def test_an_exception_and_a_deadlock_are_reported_before_the_outputs_are_released(tmp_path: Path) -> None:
    need("gcc")
    main = HERE / "devices" / "failing.c"
    program = by_the_interface(tmp_path, "tests/c_kernel/devices/failing.csp", main, "gcc")
    assert run(program).splitlines() == [
        "failed 1, cause 2 at 0 ns in Failing, failing.csp:17, exception Broken; released 0",
        f"state {FAILED}, released 1",
        "failed 1, cause 3 at 0 ns in none, nowhere, exception none; released 0",
        f"state {DEADLOCK}, released 1",
    ]


def test_a_failure_is_reported_once_before_the_outputs_are_released(machine: Path) -> None:
    assert run(machine, "fail").splitlines() == [
        "failed 0",
        "failed 1, cause 0 at 6 ms in Machine, machine.csp:14; released 0",
        "failed 1, cause 1 at 10 ms in Machine, machine.csp:14; released 0",
    ]


def test_communications_are_traced_where_the_sources_are_compiled_for_it(machine: Path, tmp_path: Path) -> None:
    assert run(machine, "trace").splitlines() == ["the hook `trace` needs -DCSP_TRACE_HOOK=1"]
    main = HERE / "devices" / "interface.c"
    traced = by_the_interface(tmp_path, "tests/c_kernel/devices/machine.csp", main, "gcc", "-DCSP_TRACE_HOOK=1")
    assert run(traced, "trace").splitlines() == [
        "2000 us: Machine.level 0>1 1",
        "4000 us: Machine.drive 1>0 1",
        "4000 us: Machine.level 0>1 2",
        "5000 us: Machine.button 0>1 1",
        "5000 us: Machine.lamp 1>0 1",
        'process Machine, no channel "", no process ""',
    ]


def test_parameters_belong_to_an_instance_and_to_its_copies(tmp_path: Path) -> None:
    """The sum of 49 samples, because an output changes at the tick after; then the same ten ticks with a gain of 7."""
    need_sanitizers("gcc", "address,undefined")
    checked = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    main = HERE / "devices" / "scaling.c"
    image = by_the_interface(tmp_path, "tests/c_kernel/devices/scaling.csp", main, "gcc", *checked)
    assert run(image).splitlines() == [
        "alone 147 245, interleaved 147 245",
        "set 1, set again 1, gain 100, drive 1120",
        "restored 1, gain 7, as before 1; the other has 0.5",
        "in the other 1, gain 7, as before 1",
    ]


@pytest.mark.parametrize("sanitizer", ["address,undefined", "thread"])
def test_no_event_of_another_thread_is_lost_unreported(sanitizer: str, tmp_path: Path) -> None:
    need("gcc")
    checked = ("-O1", f"-fsanitize={sanitizer}", "-fno-sanitize-recover=all")
    main = HERE / "devices" / "counting.c"
    image = by_the_interface(tmp_path, "tests/c_kernel/devices/counter.csp", main, "gcc", *checked)
    assert run(image).splitlines() == [f"lost unreported 0, in order 1, last 1, state {MORE}", f"stopped {STOPPED}"]


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("program", [*PROGRAMS, "models/cascade/cascade.csp", "models/emergency/emergency.csp"])
def test_the_size_in_the_header_suffices_and_is_not_much_more(program: str, level: int, tmp_path: Path) -> None:
    """That it suffices is asserted in the generated source; here it is also compiled as C++."""
    need("gcc", "g++", "nm", "arm-none-eabi-gcc")
    package(tmp_path, program, level)
    (header,) = tmp_path.glob("*_api.h")
    stem = header.stem.removesuffix("_api")
    text = f'#include "{header.stem}.c"\nchar measured[sizeof({stem}_instance)];\nchar given[{stem.upper()}_SIZE];\n'
    (tmp_path / "measure.c").write_text(text)
    (tmp_path / "user.cpp").write_text(
        f'#include "{header.name}"\nint main() {{ return {stem}_continues({stem}_state()); }}\n'
    )
    warnings = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
    compile_once("g++", "-std=c++11", *warnings, "-fsyntax-only", "user.cpp", cwd=tmp_path)
    for compiler in ("gcc", "arm-none-eabi-gcc"):
        compile_once(
            compiler, "-std=c99", f"-I{tmp_path}", f"-I{tmp_path / 'support'}", "-c", "measure.c", cwd=tmp_path
        )
        rows = [line.split() for line in run("nm", "-P", tmp_path / "measure.o").splitlines()]
        sizes = {row[0]: int(row[3], 16) for row in rows if row[0] in ("measured", "given")}
        assert sizes["measured"] <= sizes["given"] <= sizes["measured"] * 1.1


@pytest.mark.parametrize("sanitizer", ["address,undefined", "thread"])
def test_instances_do_not_touch_each_other(sanitizer: str, tmp_path: Path) -> None:
    need("gcc")
    sources = package(tmp_path, "tests/c_kernel/devices/machine.csp", 0)
    flags = (*STRICT, "-O1", "-g", f"-fsanitize={sanitizer}", "-fno-sanitize-recover=all", "-DCSP_TRACE=0")
    includes = (f"-I{tmp_path}", f"-I{tmp_path / 'support'}")
    kernel = [path for path in sources if path.stem not in (PLATFORM, "csp_run")]
    main, image = HERE / "devices" / "instances.c", tmp_path / "program"
    compile_once("gcc", *flags, *includes, *kernel, main, "-lm", "-pthread", "-o", image)
    alone, other, *rest = run(image).splitlines()
    assert alone == "0: 49 driven, sum 612.5, lamp 1, released 1"
    assert other == "0: 98 driven, sum 9702, lamp 1, released 1"
    assert rest == [alone, other] * 2


def test_two_programs_fit_in_one_image(tmp_path: Path) -> None:
    """Each as one object, of which nothing is visible but what begins with its name."""
    need("gcc", "make", "ld", "objcopy", "nm")
    made = []
    for name in ("machine", "counter"):
        folder = tmp_path / name
        package(folder, f"tests/c_kernel/devices/{name}.csp", 0)
        run("make", "-s", "-C", folder, "CFLAGS=-O1 -fno-pie", f"{name}.o")
        made.append(folder / f"{name}.o")
        symbols = [line.split() for line in run("nm", "-P", "-g", made[-1]).splitlines()]
        assert [row[0] for row in symbols if row[1] != "U" and not row[0].startswith(f"{name}_")] == []
        assert [row[0] for row in symbols if row[0].startswith("csp_")] == []
    main = HERE / "devices" / "two_programs.c"
    includes = (f"-I{tmp_path / 'machine'}", f"-I{tmp_path / 'counter'}")
    compile_once("gcc", *STRICT, "-no-pie", *includes, main, *made, "-lm", "-o", tmp_path / "program")
    assert run(tmp_path / "program").splitlines() == [f"machine {ENDED}, driven 4", f"counter {MORE}, taken 1"]


def test_the_superloop_from_an_empty_folder(tmp_path: Path) -> None:
    """The commands of its page."""
    need("cc", "make", "ld", "objcopy")
    example = ROOT / "examples" / "c" / "superloop"
    for name in ("tank.csp", "main.c"):
        (tmp_path / name).write_text((example / name).read_text(encoding="utf-8"), encoding="utf-8")
    page = (example / "README.md").read_text(encoding="utf-8")
    compiling, *commands, running = [line.split() for line in page.splitlines() if line.startswith("    ")]
    assert compiling[0] == "cspdiag"
    assert main([compiling[1], str(tmp_path / "tank.csp"), *compiling[3:5], "-o", str(tmp_path / "build")]) == 0
    for command in commands:
        run(*command, cwd=tmp_path)
    lines = run(tmp_path / running[0]).splitlines()
    assert lines == [
        "level 0.87",
        "lamp on",
        "output 0 is safe",
        "lamp off",
        "output 1 is safe",
        "ended by itself at 20.00 s",
    ]


def test_a_library_is_of_the_processor_for_which_it_was_made_last(tmp_path: Path) -> None:
    need("cc", "make", "objcopy", "arm-none-eabi-gcc", "arm-none-eabi-readelf")
    package(tmp_path, "tests/c_kernel/devices/counter.csp", 0)
    cross = ("CROSS_COMPILE=arm-none-eabi-", "CFLAGS=-Os -mcpu=cortex-m3 -mthumb")
    for options in ((), cross, ()):
        for goal in ("libcounter.a", "counter.o"):
            run("make", "-s", "-C", tmp_path, *options, goal)
            header = run("arm-none-eabi-readelf", "-h", tmp_path / goal)
            machines = {line.split()[-1] for line in header.splitlines() if line.strip().startswith("Machine:")}
            assert len(machines) == 1
            assert ("ARM" in machines) == bool(options)


NO_STATE, BEYOND = 1, 60_000
"""A state of the process itself, which its branch does not have, and one that is in no table."""


@pytest.mark.parametrize(
    ("process", "state", "instant", "noticed"),
    [
        pytest.param("branch", NO_STATE, 25, 30, id="when its sample comes"),
        pytest.param("branch", BEYOND, 25, 30, id="beyond the table"),
        pytest.param("branch", NO_STATE, 100, 100, id="when it is interrupted"),
        pytest.param("branch", BEYOND, 100, 100, id="interrupted beyond the table"),
        pytest.param("process", BEYOND, 25, 100, id="when its branch has ended"),
    ],
)
def test_an_overwritten_state_ends_the_run_with_safe_values(
    process: str, state: int, instant: int, noticed: int, tmp_path: Path
) -> None:
    need_sanitizers("gcc", "address,undefined")
    checked = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    main = HERE / "devices" / "overwritten.c"
    program = by_the_interface(tmp_path, "tests/c_kernel/devices/overwritten.csp", main, "gcc", *checked)
    assert run(program, process, str(state), str(instant)) == (
        f"{FAILED} at {noticed} ms: Fault, in Overwritten (overwritten state); overwritten state; "
        "driven -1, released 1, after that 0\n"
    )
