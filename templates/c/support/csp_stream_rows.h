/* SPDX-License-Identifier: 0BSD */
/* The rows of a run that are not sent yet, and how they are sent: csp_stream_posix.c to standard output, csp_port_board.c to a file of the host. */
#ifndef CSP_STREAM_ROWS_H
#define CSP_STREAM_ROWS_H

#include "csp_program.h"

enum { CSP_ROWS = 1 << 12 };

/* See csp_stream.h. */
typedef struct csp_row {
    uint32_t kind;
    uint32_t number;
    int64_t time;
    uint32_t writer;
    uint32_t reader;
    uint64_t value;
} csp_row;

/* The thread of the run fills the rows and may be stopped anywhere, for good. Other threads, and the one that releases outputs in its place, send only
 * whole records: `complete` rows. */
typedef struct csp_unsent_rows {
    csp_row of[CSP_ROWS];
    size_t filled;
    volatile size_t complete;
} csp_unsent_rows;

extern csp_unsent_rows csp_rows;

/* To be called before the run. */
void csp_rows_begin(void);
/* Sends all complete records, and moves an incomplete one to the front. */
void csp_rows_send(csp_kernel *csp);
/* Whether some could not be sent. */
bool csp_rows_lost(void);

#endif
