/* SPDX-License-Identifier: 0BSD */
/* For hand-written processes: ports that can be connected to anything.
 *
 * The body of `process Logger c "logger.c"` is a pair of files, logger.h and logger.c. The header includes the generated logger_ports.h and
 * defines `struct logger`, whose first member is `csp_process process`; the source defines `logger_initialize`, which logger_ports.h declares, and
 * a step function. This is a whole process, which logs what it reads:
 *
 *     struct logger {                              // logger.h
 *         csp_process process;
 *         csp_ends ends;
 *         csp_in level;
 *         double value;
 *     };
 *
 *     enum { READS_LEVEL = 1, FAILS };             // logger.c: where it waits, and where it ends unsuccessfully
 *
 *     static csp_party *logger_step(csp_kernel *csp, csp_party *party)
 *     {
 *         struct logger *const self = (struct logger *)(void *)party;
 *         csp_progress progress;
 *         switch (party->state) {
 *         case 0:
 *             csp_observe_begin(csp, party->number);
 *             for (;;) {
 *                 CSP_READ(self->level, self->value, READS_LEVEL, fails)
 *                 keep(self->value);
 *             }
 *         case FAILS:
 *         fails:
 *             csp_unwind(csp, party);
 *             csp_ends_close(&self->ends);
 *             csp_observe_end(csp, party->number);
 *             return csp_fail(csp, party);              // a normal end: the same with csp_end, and without csp_unwind
 *         default:
 *             return csp_overwritten(csp, party);
 *         }
 *     }
 *
 *     static const csp_place logger_places[] = {
 *         [0] = {.waiting = CSP_AT_NOTHING, .where = "logger.c"},
 *         [READS_LEVEL] = CSP_PLACE_READ(struct logger, level, FAILS, "logger.c"),
 *         [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "logger.c"},
 *     };
 *     static const csp_class logger_class = {
 *         .step = logger_step, .places = logger_places, .name = "Logger", .where = "logger.c", .offset = 0,
 *         .states = CSP_STATES(logger_places)};
 *
 *     void logger_initialize(struct logger *self, csp_numbers *numbers, const struct logger_ports *ports)
 *     {
 *         csp_process_init(&self->process, &logger_class, numbers->process++);
 *         csp_in_init(&self->level, ports->level, &self->ends);
 *     }
 *
 * Saved states have no pointers, so members with pointers are found in the text of the header: they are declared without #if around them or their types.
 *
 * A local variable of a step function exists until the process waits; what has to exist longer is a member of the struct. A process waits with
 * CSP_READ, CSP_WRITE, and CSP_AWAIT with csp_wait; it fails with `(void)csp_raise(csp, party, EXCEPTION_..., "logger.c:12"); goto fails;`.
 */
#ifndef CSP_LEAF_H
#define CSP_LEAF_H

#include "csp_channels.h"
#include "csp_external.h"
#include "csp_process.h"

typedef enum csp_end_kind {
    CSP_END_VARIABLE, /* a variable or a constant; NULL: discards what is written */
    CSP_END_CHANNEL,
    CSP_END_GUARDED,
    CSP_END_ANY,
    CSP_END_BROADCAST,
    CSP_END_BUFFER,
    CSP_END_SAMPLED,
    CSP_END_EVENT,
    CSP_END_LATCHED,
    CSP_END_DIRECT
} csp_end_kind;

/* What a port is connected to. */
typedef struct csp_connection {
    csp_end_kind kind;
    void *at;
    size_t size; /* size of a value */
} csp_connection;

typedef struct csp_in {
    csp_connection connection;
    csp_medium *medium; /* where it waits */
    struct {
        csp_broadcast_end broadcast;
        csp_sampled_end sampled;
        csp_event_end event;
    } end; /* one of these; a union could not be saved */
} csp_in;

typedef struct csp_out {
    csp_connection connection;
    csp_medium *medium;
} csp_out;

/* To be called before the program starts. `ends` are closed when the process ends. */
void csp_in_init(csp_in *in, csp_connection connection, csp_ends *ends);
void csp_out_init(csp_out *out, csp_connection connection);

csp_progress csp_in_read(csp_kernel *csp, csp_party *party, csp_in *in, void *value, size_t size);
csp_progress csp_in_read_again(csp_kernel *csp, csp_party *party, csp_in *in, void *value, size_t size);
/* A variable of another size than the values of the port is a fault. A value for an output of the program has to be finite: check it with csp_finite of
 * csp_arithmetic.h. */
csp_progress csp_out_write(csp_kernel *csp, csp_party *party, csp_out *out, void *value, size_t size);

#define CSP_READ(in, variable, PLACE, FAILED)                                                                          \
    CSP_AWAIT(csp_in_read(csp, party, &(in), &(variable), sizeof(variable)),                                                \
              csp_in_read_again(csp, party, &(in), &(variable), sizeof(variable)), PLACE, FAILED)

#define CSP_WRITE(out, variable, PLACE, FAILED)                                                                        \
    CSP_AWAIT(csp_out_write(csp, party, &(out), &(variable), sizeof(variable)), CSP_DONE, PLACE, FAILED)

#define CSP_PLACE_READ(TYPE, MEMBER, FAILED, WHERE)                                                                    \
    {                                                                                                                  \
        .waiting = CSP_AT_READ, .indirect = true, .failed = (FAILED), .offset = offsetof(TYPE, MEMBER.medium),         \
        .where = (WHERE)                                                                                               \
    }

#define CSP_PLACE_WRITE(TYPE, MEMBER, FAILED, WHERE)                                                                   \
    {                                                                                                                  \
        .waiting = CSP_AT_WRITE, .indirect = true, .failed = (FAILED), .offset = offsetof(TYPE, MEMBER.medium),        \
        .where = (WHERE)                                                                                               \
    }

#endif
