/* SPDX-License-Identifier: 0BSD */
/* See csp_port_board.h, csp_simulation_host.h and csp_stream_rows.h. */
#include "csp_port_board.h"

#include <string.h>

#include "csp_simulation_host.h"
#include "csp_internal.h"
#include "csp_port.h"
#include "csp_stream_rows.h"
#include "csp_stream.h"

/* Operations of the host. */
enum { OPEN = 0x01, WRITE_TEXT = 0x04, WRITE = 0x05, CLOCK = 0x10, COMMAND_LINE = 0x15, EXIT_WITH_STATUS = 0x20, APPLICATION_EXIT = 0x20026 };

enum { TO_WRITE_BYTES = 5, HUNDREDTHS = 100 };

enum { TURNS = 1024 }; /* of the run between two reports of the present instant */

enum { LONGEST_LINE = 1024, MOST_WORDS = 32, STATUS_OF_FAULT = 70 };

int main(int count, char **words);

static char line[LONGEST_LINE];
static char *words[MOST_WORDS];

void csp_board_exit(int status)
{
    const uintptr_t block[2] = {(uintptr_t)APPLICATION_EXIT, (uintptr_t)status};
    for (;;) {
        (void)csp_board_call((uint32_t)EXIT_WITH_STATUS, block);
    }
}

void csp_board_fault(void)
{
    (void)csp_board_call((uint32_t)WRITE_TEXT, "fault of the processor\n");
    csp_board_exit(STATUS_OF_FAULT);
}

/* Divides the line into its words. Returns their number. */
static int divide(void)
{
    int count = 0;
    bool inside = false;
    for (char *at = line; *at != '\0'; at++) {
        if (*at == ' ') {
            *at = '\0';
            inside = false;
        } else if (!inside && (count < (int)MOST_WORDS)) {
            words[count] = at;
            count++;
            inside = true;
        } else {
            /* The word continues. */
        }
    }
    return count;
}

void csp_board_start(void)
{
    const uintptr_t block[2] = {(uintptr_t)line, sizeof line};
    (void)csp_board_call((uint32_t)COMMAND_LINE, block);
    csp_board_exit(main(divide(), words));
}

/* ---- What a simulation needs ---- */

csp_unsent_rows csp_rows;

const char csp_host_options[] = "[--stream FILE]";

static const char *stream; /* the file of the host for the records; NULL: there is none */
static intptr_t handle = -1;
static bool lost;

bool csp_host_option(const char *option, const char *value)
{
    stream = value;
    return strcmp(option, "--stream") == 0;
}

void csp_host_begin(void)
{
    /* There are no signals. */
}

const csp_tuning *csp_host_tuning(void)
{
    return NULL;
}

csp_ending csp_host_run(csp_kernel *csp, int64_t until)
{
    return csp_run(csp, until);
}

double csp_host_seconds(void)
{
    return (double)csp_board_call((uint32_t)CLOCK, NULL) / (double)HUNDREDTHS;
}

void csp_host_say(const char *text)
{
    (void)csp_board_call((uint32_t)WRITE_TEXT, text);
}

int csp_host_status(csp_ending ending)
{
    return ((ending == CSP_TERMINATED) || (ending == CSP_TIME_LIMIT)) ? 0 : 1;
}

/* No other thread looks at the run, as on POSIX. */
void csp_port_alive(void)
{
    static uint32_t turns;
    turns++;
    if ((turns % (uint32_t)TURNS) == 0U) {
        csp_stream_present(csp_owned());
        csp_rows_send(csp_owned());
    }
}

void csp_rows_begin(void)
{
    if (stream != NULL) {
        const uintptr_t block[3] = {(uintptr_t)stream, (uintptr_t)TO_WRITE_BYTES, strlen(stream)};
        handle = csp_board_call((uint32_t)OPEN, block);
    }
}

void csp_rows_send(csp_kernel *csp)
{
    const uintptr_t block[3] = {(uintptr_t)handle, (uintptr_t)csp_rows.of, csp_rows.complete * sizeof(csp_row)};
    if ((handle < 0) || (csp_board_call((uint32_t)WRITE, block) != 0)) { /* the number of bytes that were not written */
        lost = true;
        csp_request_stop(csp);
    }
    (void)memmove(csp_rows.of, &csp_rows.of[csp_rows.complete], (csp_rows.filled - csp_rows.complete) * sizeof(csp_row));
    csp_rows.filled -= csp_rows.complete;
    csp_rows.complete = 0U;
}

bool csp_rows_lost(void)
{
    return lost;
}

/* ---- What the library needs ---- */

#if defined(__NEWLIB__) && !defined(__PICOLIBC__)

int _write(int file, const char *bytes, int size);
void _exit(int status);

int _write(int file, const char *bytes, int size)
{
    (void)file;
    for (int index = 0; index < size; index++) {
        const char text[2] = {bytes[index], '\0'};
        (void)csp_board_call((uint32_t)WRITE_TEXT, text);
    }
    return size;
}

void _exit(int status)
{
    csp_board_exit(status);
    for (;;) {
        /* Does not return. */
    }
}

#endif
