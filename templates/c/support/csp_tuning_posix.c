/* See csp_tuning.h. */
#define _POSIX_C_SOURCE 200809L /* read */

#include "csp_tuning.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "csp_stream.h"

static int source = -1;
static csp_change upcoming;
static unsigned char value[CSP_LARGEST_CHANGE];
static bool has_upcoming;

bool csp_tuning_open(const char *path)
{
    source = open(path, O_RDONLY | O_NONBLOCK);
    return source >= 0;
}

/* Records are written whole, so what can be read begins with a whole one. */
static void read_change(void)
{
    has_upcoming = (read(source, &upcoming, sizeof upcoming) == (ssize_t)sizeof upcoming) &&
                   (upcoming.size <= (uint32_t)CSP_LARGEST_CHANGE) &&
                   (read(source, value, upcoming.size) == (ssize_t)upcoming.size);
}

static int64_t next(void)
{
    if (!has_upcoming) {
        read_change();
    }
    return has_upcoming ? upcoming.time : INT64_MAX;
}

static bool is_made(csp_kernel *csp)
{
    static unsigned char parameters[CSP_LARGEST_CHANGE];
    const csp_program *const program = csp->program;
    const size_t size = program->parameters_size;
    if ((size > sizeof parameters) || (upcoming.offset > size) || (upcoming.size > (size - upcoming.offset))) {
        return false;
    }
    (void)memcpy(parameters, (const char *)csp + program->parameters, size);
    (void)memcpy(&parameters[upcoming.offset], value, upcoming.size);
    return program->set_parameters(csp, parameters);
}

static void make(csp_kernel *csp, int64_t instant)
{
    while (next() <= instant) {
        csp_stream_change(csp, upcoming.number, instant, is_made(csp));
        has_upcoming = false;
    }
}

const csp_tuning *csp_tuning_opened(void)
{
    static const csp_tuning tuning = {next, make};
    return (source >= 0) ? &tuning : NULL;
}
