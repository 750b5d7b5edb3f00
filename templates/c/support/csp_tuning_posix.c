/* See csp_tuning.h. */
#define _POSIX_C_SOURCE 200809L /* read */

#include "csp_tuning.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "csp_stream.h"

/* A change that is still to be made. */
typedef struct planned {
    csp_change change;
    struct planned *later;
    unsigned char value[];
} planned;

static int source = -1;
static planned *first;

bool csp_tuning_open(const char *path)
{
    source = open(path, O_RDONLY | O_NONBLOCK);
    return source >= 0;
}

/* After those of the same time: they are made in the order in which they came. */
static void plan(planned *added)
{
    planned **place = &first;
    while ((*place != NULL) && ((*place)->change.time <= added->change.time)) {
        place = &(*place)->later;
    }
    added->later = *place;
    *place = added;
}

static bool read_change(void)
{
    csp_change change;
    const ssize_t size = read(source, &change, sizeof change);
    if (size == 0) { /* Nothing more will come. */
        (void)close(source);
        source = -1;
    }
    if ((size != (ssize_t)sizeof change) || (change.size > (uint32_t)CSP_LARGEST_CHANGE)) {
        return false;
    }
    planned *const added = malloc(sizeof *added + change.size);
    if (added == NULL) {
        return false;
    }
    added->change = change;
    if (read(source, added->value, change.size) != (ssize_t)change.size) {
        free(added);
        return false;
    }
    plan(added);
    return true;
}

/* Records are written whole, so what can be read begins with a whole one. */
static int64_t next(void)
{
    while ((source >= 0) && read_change()) {
    }
    return (first != NULL) ? first->change.time : INT64_MAX;
}

static bool is_made(csp_kernel *csp)
{
    static unsigned char parameters[CSP_LARGEST_CHANGE];
    const csp_program *const program = csp->program;
    const csp_change *const change = &first->change;
    const size_t size = program->parameters_size;
    if ((size > sizeof parameters) || (change->offset > size) || (change->size > (size - change->offset))) {
        return false;
    }
    (void)memcpy(parameters, (const char *)csp + program->parameters, size);
    (void)memcpy(&parameters[change->offset], first->value, change->size);
    return program->set_parameters(csp, parameters);
}

static void make(csp_kernel *csp, int64_t instant)
{
    while (next() <= instant) {
        planned *const made = first;
        csp_stream_change(csp, made->change.number, instant, is_made(csp));
        first = made->later;
        free(made);
    }
}

const csp_tuning *csp_tuning_opened(void)
{
    static const csp_tuning tuning = {next, make};
    return (source >= 0) ? &tuning : NULL;
}
