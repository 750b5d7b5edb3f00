"""A law by hand continues from a saved state with its pointers: in another instance, and in another process."""

from __future__ import annotations

import subprocess
from pathlib import Path

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from tests.c_kernel.building import STRICT, need
from tests.codegen.c.test_package import written
from tests.support.compiling import compile_once

PROGRAM = """
submodel Law(gain: double) c "law.c" { in level : double  out opening : double }
process Tank {
  in  level   : double @ 10 ms
  out opening : double @ 10 ms
  communication {
    law : Law(gain = 2)
    level       -> law.level
    law.opening -> opening
  }
  composition { mu law }
}
"""
HEADER = """\
#ifndef LAW_H
#define LAW_H
#include <stdint.h>
#ifdef SMALL
#define ROOM 2
#else
#define ROOM 5
#endif
struct sensor { double *at; char kind; };
typedef struct { double *p; intptr_t number; } items[2];
#define N 1
struct first { double *p[N]; intptr_t numbers[2]; };
#undef N
#define N 3
struct law {
    double level, opening, gain;
    struct { double *p; } slot[sizeof(struct sensor) / 4];
    struct { double *q; intptr_t number; } room[ROOM];
    intptr_t numbers[3];
    items w[3];
    struct { struct { double *p, *r[2]; intptr_t number; } in[2]; } x[2][3];
    struct first first;
    double *none[ROOM - 2];
    struct { double *q[ROOM - 2]; } nothing[2];
    double line[4] __attribute__((aligned(64)));
    double *p[N];
    double (*twice)(double value);
    const char *const *texts;
    double sum;
};
void law_initialize(struct law *self, double gain);
void law_reset(struct law *self);
void law_calculate(struct law *self);
#endif
"""
LAW = """\
#include "law.h"
#define EACH(array, i) for (unsigned i = 0U; i < sizeof(array) / sizeof((array)[0]); i++)
static const char *const texts[] = {"a", "bc"};
static double twice(double value)
{
    return 2.0 * value;
}
void law_initialize(struct law *self, double gain)
{
    self->gain = gain;
    law_reset(self);
}
void law_reset(struct law *self)
{
    double *const sum = &self->sum;
    self->sum = 0.0;
    self->twice = twice;
    self->texts = texts;
    EACH(self->slot, i) { self->slot[i].p = sum; }
    EACH(self->room, i) { self->room[i].q = sum; self->room[i].number = 1000; }
    EACH(self->numbers, i) { self->numbers[i] = 1000; self->first.numbers[i % 2U] = 2000; }
    EACH(self->w, i) { EACH(self->w[i], k) { self->w[i][k].p = sum; self->w[i][k].number = 3000; } }
    EACH(self->x, i) { EACH(self->x[i], k) { EACH(self->x[i][k].in, m) {
        self->x[i][k].in[m].p = self->x[i][k].in[m].r[0] = self->x[i][k].in[m].r[1] = sum;
        self->x[i][k].in[m].number = 4000;
    } } }
    self->first.p[0] = sum;
    EACH(self->p, i) { self->p[i] = sum; }
}
void law_calculate(struct law *self)
{
    intptr_t numbers = 0;
    EACH(self->slot, i) { *self->slot[i].p += self->level; }
    EACH(self->room, i) { *self->room[i].q += self->level; numbers += self->room[i].number; }
    EACH(self->numbers, i) { numbers += self->numbers[i] + self->first.numbers[i % 2U]; }
    EACH(self->w, i) { EACH(self->w[i], k) { *self->w[i][k].p += self->level; numbers += self->w[i][k].number; } }
    EACH(self->x, i) { EACH(self->x[i], k) { EACH(self->x[i][k].in, m) {
        *self->x[i][k].in[m].p += *self->x[i][k].in[m].r[0] - *self->x[i][k].in[m].r[1];
        numbers += self->x[i][k].in[m].number;
    } } }
    EACH(self->p, i) { *self->p[i] += self->level; }
    *self->first.p[0] += self->level;
    self->opening = self->gain * self->twice(self->sum) + (double)numbers + (double)self->texts[1][1];
}
"""
MAIN = r"""
#include <stdio.h>
#include <string.h>
#include "tank_api.h"
#define UNTIL(ms) ((ms) * INT64_C(1000000) + 1)
typedef struct plant { double level, opening; } plant;
static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    (void)input;
    inputs->level = (((plant *)context)->level += 1.0);
    return true;
}
static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    (void)output;
    (void)safe;
    ((plant *)context)->opening = outputs->opening;
}
int main(int argc, char **argv)
{
    static tank_memory own, other, copy, before;
    static struct { char first; tank_memory own; unsigned char more[16]; } shifted;
    plant of_own = {0.0, 0.0}, of_other = {100.0, 0.0};
    const tank_hooks hooks = {.context = &of_own, .sample = sample, .actuate = actuate};
    const tank_hooks others = {.context = &of_other, .sample = sample, .actuate = actuate};
    tank_instance *const instance = tank_begin(&own, sizeof own, &hooks, NULL);
    tank_instance *const another = tank_begin(&other, sizeof other, &others, NULL);
    (void)tank_advance(instance, UNTIL(50), 1000U);
    (void)argc;
    void *const misaligned = shifted.own.bytes + 16;
    if ((uintptr_t)&shifted.own % 64U != 0U || tank_begin(misaligned, sizeof own, &hooks, NULL) != NULL) {
        return 2;
    }
    if (strcmp(argv[1], "keep") == 0) {
        tank_save(instance, &copy);
        (void)fwrite(&copy, sizeof copy, 1U, stdout);
        (void)tank_advance(instance, UNTIL(90), 1000U);
        (void)fprintf(stderr, "%.17g\n", of_own.opening);
        return 0;
    }
    if (fread(&copy, sizeof copy, 1U, stdin) != 1U) {
        return 1;
    }
    of_other.level = of_own.level;
    before = own;
    const bool restored = tank_restore(another, &copy);
    (void)tank_advance(another, UNTIL(90), 1000U);
    (void)printf("%d %d %.17g\n", restored, memcmp(&before, &own, sizeof own) == 0, of_other.opening);
    return 0;
}
"""


def test_pointers_of_a_law_are_restored(tmp_path: Path) -> None:
    need("gcc")
    (tmp_path / "law.h").write_text(HEADER)
    (tmp_path / "law.c").write_text(LAW)
    built = pipeline.build(SourceFile(name=str(tmp_path / "tank.csp"), text=PROGRAM), read_source)
    assert built.network is not None
    package = written(pipeline.generate(built.network, read_source, "c"), tmp_path / "package")
    (tmp_path / "main.c").write_text(MAIN)
    left = ("csp_port_", "csp_linear", "csp_signals", "csp_simulation", "csp_steering", "csp_stream", "csp_tuning")
    sources = [
        path
        for path in sorted(package.rglob("*.c"))
        if not path.name.startswith((*left, "main_", "csp_watch", "csp_platform", "csp_run"))
    ]
    flags = [flag for flag in STRICT if flag != "-Wpedantic"]  # ISO C has no arrays without elements.
    command = ["gcc", *flags, "-O0", "-DSMALL", "-fPIE", "-pie", f"-I{package}", f"-I{package / 'support'}"]
    compile_once(*command, *sources, tmp_path / "main.c", "-lm", "-o", tmp_path / "program")
    kept = subprocess.run([tmp_path / "program", "keep"], capture_output=True, check=True, timeout=10)
    resumed = subprocess.run(
        [tmp_path / "program", "resume"], input=kept.stdout, capture_output=True, check=True, timeout=10
    )
    assert resumed.stdout.decode() == f"1 1 {kept.stderr.decode()}"
