/* SPDX-License-Identifier: 0BSD
 *
 * Spindle as a part of your own program: in steps that never wait, with all its state in memory
 * that you give. A superloop:
 *
 *     static emergency_memory memory;
 *     static const emergency_hooks hooks = { ... };
 *     emergency_instance *const self = emergency_begin(&memory, sizeof memory, &hooks, NULL);
 *     while (emergency_continues(emergency_advance(self, nanoseconds_since_then(), 64U))) {
 *         sleep_until(emergency_next(self));
 *     }
 *
 * There may be several instances, also in several threads. One instance belongs to one thread, from
 * which all functions are called but those of which it is said that they may be called from
 * anywhere. Times are nanoseconds since emergency_begin.
 */
#ifndef EMERGENCY_API_H
#define EMERGENCY_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "emergency_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes that an instance takes at most, and memory for one, which has to be zero before it is
 * used for the first time.
 */
#if UINTPTR_MAX > 0xFFFFFFFFU
#define EMERGENCY_SIZE 1896U
#else
#define EMERGENCY_SIZE 1280U
#endif
typedef union emergency_memory {
    int64_t alignment;
    double alignment_of_reals;
    void *alignment_of_pointers;
    unsigned char bytes[EMERGENCY_SIZE];
} emergency_memory;

typedef struct emergency_instance emergency_instance;

/* Sampled inputs, and a name for each. */
typedef struct emergency_inputs {
    double feedback; /* In rad/s, every 2 ms. */
} emergency_inputs;
typedef enum emergency_input {
    EMERGENCY_IN_FEEDBACK
} emergency_input;

/* Outputs, and a name for each. */
typedef struct emergency_outputs {
    double control; /* In V, every 2 ms. */
    bool brake; /* Every 2 ms. */
    bool halted;
} emergency_outputs;
typedef enum emergency_output {
    EMERGENCY_OUT_CONTROL,
    EMERGENCY_OUT_BRAKE,
    EMERGENCY_OUT_HALTED
} emergency_output;

/* A name for each event. */
typedef enum emergency_event {
    EMERGENCY_EVENT_PANEL
} emergency_event;

/* The longest execution times, in cycles: a step of each process, from one wait to the next; all
 * work at one instant, with your hooks; and what of it is outside of steps: samples, outputs,
 * timers, and the choice of the next process. They stay when a run begins.
 */
#define EMERGENCY_PROCESSES 1U
typedef struct emergency_times {
    uint32_t process[EMERGENCY_PROCESSES];
    uint32_t instant;
    uint32_t kernel;
} emergency_times;

/* A communication. Channels have numbers, first the ports, in the order of the text; so do
 * processes, from 1, and 0 is the environment. emergency_channel_name and
 * emergency_process_name say which they are.
 */
typedef enum emergency_port {
    EMERGENCY_PORT_PANEL,
    EMERGENCY_PORT_FEEDBACK,
    EMERGENCY_PORT_CONTROL,
    EMERGENCY_PORT_BRAKE,
    EMERGENCY_PORT_HALTED
} emergency_port;

typedef struct emergency_communication {
    int64_t instant;
    uint32_t channel;
    uint32_t writer;
    uint32_t reader;
    const void *value; /* of the type of the channel; valid during the call */
    size_t size;
} emergency_communication;

/* Why a run has failed. What is not known, or does not apply, is NULL. */
typedef enum emergency_cause {
    EMERGENCY_CAUSE_FAULT,     /* of a computation, or of a device */
    EMERGENCY_CAUSE_TIMEOUT,   /* a sample was overwritten untaken */
    EMERGENCY_CAUSE_EXCEPTION, /* which the program has declared */
    EMERGENCY_CAUSE_DEADLOCK   /* nothing can continue it */
} emergency_cause;
typedef struct emergency_failure {
    emergency_cause cause;
    int64_t instant;
    uint32_t number;       /* of the process; 0: none */
    const char *process;   /* its name in the program, */
    const char *inner;     /* the process below it that the optimizer has inlined, */
    const char *law;       /* and the control law in that */
    const char *place;     /* in the text of the program: "tank.csp:12" */
    const char *exception; /* its name */
} emergency_failure;

/* What the program asks of you. `context` is passed to all functions. */
typedef struct emergency_hooks {
    void *context;
    /* Whether time passes by itself. Then a tick that is followed by another one up to the instant
     * of emergency_advance is a missed sample, because nobody has looked. Otherwise every tick is
     * executed in its turn, however long the steps are.
     */
    bool real_time;
    /* Stores the sample of this input in its member of `inputs`; false: there is no new one. */
    bool (*sample)(void *context, emergency_input input, emergency_inputs *inputs);
    /* Stores the value of this event, of the type that its function has; false: it has not
     * occurred. Asked at each multiple of `grid`, first at `grid` itself, before samples are taken.
     * NULL: events come by their functions only.
     */
    bool (*poll)(void *context, emergency_event event, void *value);
    /* Nanoseconds; 0 or less: the greatest common divisor of the periods, or 1 ms. */
    int64_t grid;
    /* Hands this output over. `safe`: it is its safe value, and its last. */
    void (*actuate)(void *context, emergency_output output, const emergency_outputs *outputs,
        bool safe);
    /* Around accesses to events that other threads or interrupt handlers bring. May be nested: the
     * result of `lock` is passed to `unlock`.
     */
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
    emergency_times *times;
    /* If sources are compiled with -DCSP_TRACE_HOOK=1: each communication of a port, and of each
     * channel that the optimizer has left, when its value has been passed. May be NULL.
     */
    void (*trace)(void *context, const emergency_communication *communication);
    /* The run has failed: emergency_diagnose says why. Safe values are handed over next. May be
     * NULL.
     */
    void (*fault)(void *context, const emergency_instance *self);
} emergency_hooks;

typedef enum emergency_state {
    EMERGENCY_MORE,     /* everything up to the instant is done */
    EMERGENCY_BUDGET,   /* the steps are used up, and something is still due: call again */
    EMERGENCY_REFUSED,  /* nothing was done: the instant is past or too far, or nothing runs */
    /* The run is over, and the outputs have their safe values: */
    EMERGENCY_ENDED,    /* by itself */
    EMERGENCY_FAILED,   /* by an exception or a fault */
    EMERGENCY_DEADLOCK, /* nothing can continue it */
    EMERGENCY_STOPPED   /* by emergency_stop */
} emergency_state;

/* Begins a run. In memory that has an instance already this is a reset, which hands over safe
 * values first; no event function may run meanwhile. If something is wrong it does nothing, returns
 * NULL, and says what it is in `*reason`, which is NULL otherwise; `reason` may be NULL.
 */
emergency_instance *emergency_begin(void *memory, size_t size, const emergency_hooks *hooks,
    const char **reason);

/* Runs everything that is due up to the instant, with at most this number of steps of processes.
 * Never waits. The last instant of any run is 9223372036 s, after 292 years.
 */
emergency_state emergency_advance(emergency_instance *self, int64_t until, uint32_t steps);

/* Whether the run continues after this result of emergency_advance. */
static inline bool emergency_continues(emergency_state state)
{
    return (state == EMERGENCY_MORE) || (state == EMERGENCY_BUDGET);
}

/* The next instant at which something is due; INT64_MAX, to which no run advances: nothing but
 * events, so wait for one.
 */
int64_t emergency_next(emergency_instance *self);

/* Hands over what the outputs have for this instant, up to which everything is done, before
 * emergency_advance takes its samples: for simulators that exchange values between steps.
 */
void emergency_hand_over(emergency_instance *self, int64_t instant);

/* Ends the run, and hands over safe values. */
void emergency_finish(emergency_instance *self);

/* Hands over safe values now, and nothing after them: for fault handlers. If they return, the next
 * emergency_advance to an instant that is not past ends the run: it answers
 * EMERGENCY_STOPPED. */
void emergency_release(emergency_instance *self);

/* Makes the run end at its next step. May be called from anywhere. */
void emergency_stop(emergency_instance *self);

/* Copies the state into memory for one instance. The copy has no pointers: it may be kept in a file
 * or in flash. What pointers of structs by hand point to, outside of the instance, is not copied:
 * it has to be a static object, a function or a text of the program. Of memory that has no instance
 * there is nothing to restore.
 */
void emergency_save(const emergency_instance *self, emergency_memory *copy);

/* Continues from a copy of this or another instance, also of an earlier run of this image, at the
 * instant at which it was made. Hooks stay, but for `grid`, and events that have not occurred yet
 * are lost. No event function may run meanwhile. False: the copy is damaged or of another image,
 * and nothing was done.
 */
bool emergency_restore(emergency_instance *self, const emergency_memory *copy);

/* Writes what has failed and where, or which processes wait for what; in a fault handler of the
 * processor, which process was running. At most `size` characters, including the terminating 0.
 */
void emergency_describe(emergency_instance *self, char *text, size_t size);

/* Why the run has failed, without a text; false: it has not. */
bool emergency_diagnose(const emergency_instance *self, emergency_failure *failure);

/* The name of a channel or port, and of a process; "" if there is none of this number, or sources
 * are compiled without -DCSP_TRACE_HOOK=1.
 */
const char *emergency_channel_name(uint32_t channel);
const char *emergency_process_name(uint32_t process);

/* Writes the longest times, part by part, as JSON for `cspdiag verify --timing --wcet-from`, if
 * sources are compiled with -DCSP_MEASURE=1; `hertz` is the frequency of the counter. Nothing is
 * written for a frequency of 0.
 */
void emergency_write_times(const emergency_times *times, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context);

/* Events. Each function may be called from anywhere; the event occurs at the next step, and of
 * several before it the last counts. True: one before it has not been read, and is lost unless it
 * is read in the present step. The function of a port whose name another function or type has
 * ends in a number: emergency_stop_2.
 */
bool emergency_panel(emergency_instance *self, enum emergency_button value);

#ifdef __cplusplus
}
#endif

#endif
