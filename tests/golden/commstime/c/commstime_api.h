/* SPDX-License-Identifier: 0BSD
 *
 * Commstime as a part of your own program: in steps that never wait, with all its state in memory
 * that you give. A superloop:
 *
 *     static commstime_memory memory;
 *     static const commstime_hooks hooks = { ... };
 *     commstime_instance *const self = commstime_begin(&memory, sizeof memory, &hooks, NULL);
 *     while (commstime_continues(commstime_advance(self, nanoseconds_since_then(), 64U))) {
 *         sleep_until(commstime_next(self));
 *     }
 *
 * There may be several instances, also in several threads. One instance belongs to one thread, from
 * which all functions are called but those of which it is said that they may be called from
 * anywhere. Times are nanoseconds since commstime_begin.
 */
#ifndef COMMSTIME_API_H
#define COMMSTIME_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes that an instance takes at most, and memory for one, which has to be zero before it is
 * used for the first time.
 */
#if UINTPTR_MAX > 0xFFFFFFFFU
#define COMMSTIME_SIZE 1112U
#else
#define COMMSTIME_SIZE 776U
#endif
typedef union commstime_memory {
    int64_t alignment;
    double alignment_of_reals;
    void *alignment_of_pointers;
    unsigned char bytes[COMMSTIME_SIZE];
} commstime_memory;

typedef struct commstime_instance commstime_instance;

/* The longest execution times, in cycles: a step of each process, from one wait to the next; all
 * work at one instant, with your hooks; and what of it is outside of steps: samples, outputs,
 * timers, and the choice of the next process. They stay when a run begins.
 */
#define COMMSTIME_PROCESSES 5U
typedef struct commstime_times {
    uint32_t process[COMMSTIME_PROCESSES];
    uint32_t instant;
    uint32_t kernel;
} commstime_times;

/* A communication. Channels have numbers, first the ports, in the order of the text; so do
 * processes, from 1, and 0 is the environment. commstime_channel_name and
 * commstime_process_name say which they are.
 */
typedef struct commstime_communication {
    int64_t instant;
    uint32_t channel;
    uint32_t writer;
    uint32_t reader;
    const void *value; /* of the type of the channel; valid during the call */
    size_t size;
} commstime_communication;

/* Why a run has failed. What is not known, or does not apply, is NULL. */
typedef enum commstime_cause {
    COMMSTIME_CAUSE_FAULT,     /* of a computation, or of a device */
    COMMSTIME_CAUSE_TIMEOUT,   /* a sample was overwritten untaken */
    COMMSTIME_CAUSE_EXCEPTION, /* which the program has declared */
    COMMSTIME_CAUSE_DEADLOCK   /* nothing can continue it */
} commstime_cause;
typedef struct commstime_failure {
    commstime_cause cause;
    int64_t instant;
    uint32_t number;       /* of the process; 0: none */
    const char *process;   /* its name in the program, */
    const char *inner;     /* the process below it that the optimizer has inlined, */
    const char *law;       /* and the control law in that */
    const char *place;     /* in the text of the program: "tank.csp:12" */
    const char *exception; /* its name */
} commstime_failure;

/* What the program asks of you. `context` is passed to all functions. */
typedef struct commstime_hooks {
    void *context;
    /* Whether time passes by itself. Then a tick that is followed by another one up to the instant
     * of commstime_advance is a missed sample, because nobody has looked. Otherwise every tick is
     * executed in its turn, however long the steps are.
     */
    bool real_time;
    /* Not needed by this program, which has no events; may be NULL. */
    uint32_t (*lock)(void *context);
    void (*unlock)(void *context, uint32_t before);
    /* An event or a request to stop has come; called where that came from. May be NULL. */
    void (*wake)(void *context);
    /* Called at least once in each step, for a watchdog. May be NULL. */
    void (*alive)(void *context);
    /* If sources are compiled with -DCSP_MEASURE=1: a counter of the processor's cycles, which may
     * overflow, and where the longest times are stored. May be NULL.
     */
    uint32_t (*cycles)(void *context);
    commstime_times *times;
    /* If sources are compiled with -DCSP_TRACE_HOOK=1: each communication of a port, and of each
     * channel that the optimizer has left, when its value has been passed. May be NULL.
     */
    void (*trace)(void *context, const commstime_communication *communication);
    /* The run has failed: commstime_diagnose says why. Safe values are handed over next. May be
     * NULL.
     */
    void (*fault)(void *context, const commstime_instance *self);
} commstime_hooks;

typedef enum commstime_state {
    COMMSTIME_MORE,     /* everything up to the instant is done */
    COMMSTIME_BUDGET,   /* the steps are used up, and something is still due: call again */
    COMMSTIME_REFUSED,  /* nothing was done: the instant is past or too far, or nothing runs */
    /* The run is over, and the outputs have their safe values: */
    COMMSTIME_ENDED,    /* by itself */
    COMMSTIME_FAILED,   /* by an exception or a fault */
    COMMSTIME_DEADLOCK, /* nothing can continue it */
    COMMSTIME_STOPPED   /* by commstime_stop */
} commstime_state;

/* Begins a run. In memory that has an instance already this is a reset, which hands over safe
 * values first; no event function may run meanwhile. If something is wrong it does nothing, returns
 * NULL, and says what it is in `*reason`, which is NULL otherwise; `reason` may be NULL.
 */
commstime_instance *commstime_begin(void *memory, size_t size, const commstime_hooks *hooks,
    const char **reason);

/* Runs everything that is due up to the instant, with at most this number of steps of processes.
 * Never waits. The last instant of any run is 9223372036 s, after 292 years.
 */
commstime_state commstime_advance(commstime_instance *self, int64_t until, uint32_t steps);

/* Whether the run continues after this result of commstime_advance. */
static inline bool commstime_continues(commstime_state state)
{
    return (state == COMMSTIME_MORE) || (state == COMMSTIME_BUDGET);
}

/* The next instant at which something is due; INT64_MAX, to which no run advances: nothing but
 * events, so wait for one.
 */
int64_t commstime_next(commstime_instance *self);

/* Hands over what the outputs have for this instant, up to which everything is done, before
 * commstime_advance takes its samples: for simulators that exchange values between steps.
 */
void commstime_hand_over(commstime_instance *self, int64_t instant);

/* Ends the run, and hands over safe values. */
void commstime_finish(commstime_instance *self);

/* Hands over safe values now, and nothing after them: for fault handlers. If they return, the next
 * commstime_advance to an instant that is not past ends the run: it answers
 * COMMSTIME_STOPPED. */
void commstime_release(commstime_instance *self);

/* Makes the run end at its next step. May be called from anywhere. */
void commstime_stop(commstime_instance *self);

/* Copies the state into memory for one instance. The copy has no pointers: it may be kept in a file
 * or in flash. What pointers of structs by hand point to, outside of the instance, is not copied:
 * it has to be a static object, a function or a text of the program. Of memory that has no instance
 * there is nothing to restore.
 */
void commstime_save(const commstime_instance *self, commstime_memory *copy);

/* Continues from a copy of this or another instance, also of an earlier run of this image, at the
 * instant at which it was made. Hooks stay, but for `grid`, and events that have not occurred yet
 * are lost. No event function may run meanwhile. False: the copy is damaged or of another image,
 * and nothing was done.
 */
bool commstime_restore(commstime_instance *self, const commstime_memory *copy);

/* Writes what has failed and where, or which processes wait for what; in a fault handler of the
 * processor, which process was running. At most `size` characters, including the terminating 0.
 */
void commstime_describe(commstime_instance *self, char *text, size_t size);

/* Why the run has failed, without a text; false: it has not. */
bool commstime_diagnose(const commstime_instance *self, commstime_failure *failure);

/* The name of a channel or port, and of a process; "" if there is none of this number, or sources
 * are compiled without -DCSP_TRACE_HOOK=1.
 */
const char *commstime_channel_name(uint32_t channel);
const char *commstime_process_name(uint32_t process);

/* Writes the longest times, part by part, as JSON for `cspdiag verify --timing --wcet-from`, if
 * sources are compiled with -DCSP_MEASURE=1; `hertz` is the frequency of the counter. Nothing is
 * written for a frequency of 0.
 */
void commstime_write_times(const commstime_times *times, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context);

#ifdef __cplusplus
}
#endif

#endif
