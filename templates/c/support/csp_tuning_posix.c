/* SPDX-License-Identifier: 0BSD */
/* See csp_tuning.h. */
#define _POSIX_C_SOURCE 200809L /* poll */

#include "csp_tuning.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
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

static void end_source(void)
{
    (void)close(source);
    source = -1;
}

/* Reads what is left of a record whose beginning was there: it is on its way, unless its writer has ended. */
static bool read_rest(void *into, size_t size)
{
    unsigned char *place = into;
    size_t left = size;
    while (left > 0U) {
        const ssize_t count = read(source, place, left);
        if (count > 0) {
            place += count;
            left -= (size_t)count;
        } else if ((count < 0) && ((errno == EAGAIN) || (errno == EINTR))) {
            struct pollfd waiting = {source, POLLIN, 0};
            (void)poll(&waiting, 1, -1);
        } else {
            return false;
        }
    }
    return true;
}

static bool read_change(void)
{
    csp_change change;
    const ssize_t begun = read(source, &change, sizeof change);
    if (begun < 0) {
        return false; /* nothing has come */
    }
    planned *added = NULL;
    if ((begun > 0) && read_rest((unsigned char *)&change + begun, sizeof change - (size_t)begun)) {
        added = malloc(sizeof *added + change.size);
    }
    if ((added == NULL) || !read_rest(added->value, change.size)) {
        free(added);
        end_source();
        return false;
    }
    added->change = change;
    plan(added);
    return true;
}

static int64_t next(void)
{
    while ((source >= 0) && read_change()) {
    }
    return (first != NULL) ? first->change.time : INT64_MAX;
}

static bool is_made(csp_kernel *csp)
{
    const csp_program *const program = csp->program;
    const csp_change *const change = &first->change;
    const size_t size = program->parameters_size;
    if ((change->offset > size) || (change->size > (size - change->offset))) {
        return false;
    }
    unsigned char *const parameters = malloc(size);
    if (parameters == NULL) {
        return false;
    }
    (void)memcpy(parameters, (const char *)csp + program->parameters, size);
    (void)memcpy(&parameters[change->offset], first->value, change->size);
    const bool made = program->set_parameters(csp, parameters);
    free(parameters);
    return made;
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
