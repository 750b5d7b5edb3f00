/* SPDX-License-Identifier: 0BSD
 *
 * Jiwy as a part of your own program: in steps that never wait, with all its state in memory
 * that you give. A superloop:
 *
 *     static jiwy_memory memory;
 *     static const jiwy_hooks hooks = { ... };
 *     jiwy_instance *const self = jiwy_begin(&memory, sizeof memory, &hooks, NULL);
 *     while (jiwy_continues(jiwy_advance(self, nanoseconds_since_then(), 64U))) {
 *         sleep_until(jiwy_next(self));
 *     }
 *
 * There may be several instances, also in several threads. One instance belongs to one thread, from
 * which all functions are called but those of which it is said that they may be called from
 * anywhere. Times are nanoseconds since jiwy_begin.
 */
#ifndef JIWY_API_H
#define JIWY_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "jiwy_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes that an instance takes at most, and memory for one, which has to be zero before it is
 * used for the first time.
 */
#if UINTPTR_MAX > 0xFFFFFFFFU
#define JIWY_SIZE 8928U
#else
#define JIWY_SIZE 6240U
#endif
typedef union jiwy_memory {
    int64_t alignment;
    double alignment_of_reals;
    void *alignment_of_pointers;
    unsigned char bytes[JIWY_SIZE];
} jiwy_memory;

typedef struct jiwy_instance jiwy_instance;

/* Sampled inputs, and a name for each. */
typedef struct jiwy_inputs {
    double joystick_horizontal; /* Every 2 ms. */
    double joystick_vertical; /* Every 1 ms. */
    double feedback_horizontal; /* In rad, every 2 ms. */
    double feedback_vertical; /* In rad, every 1 ms. */
} jiwy_inputs;
typedef enum jiwy_input {
    JIWY_IN_JOYSTICK_HORIZONTAL,
    JIWY_IN_JOYSTICK_VERTICAL,
    JIWY_IN_FEEDBACK_HORIZONTAL,
    JIWY_IN_FEEDBACK_VERTICAL
} jiwy_input;

/* Outputs, and a name for each. */
typedef struct jiwy_outputs {
    double control_horizontal; /* In V, every 2 ms. */
    double control_vertical; /* In V, every 1 ms. */
} jiwy_outputs;
typedef enum jiwy_output {
    JIWY_OUT_CONTROL_HORIZONTAL,
    JIWY_OUT_CONTROL_VERTICAL
} jiwy_output;

/* A name for each event. */
typedef enum jiwy_event {
    JIWY_EVENT_JOYSTICK_BUTTONS
} jiwy_event;

/* The longest execution times, in cycles: a step of each process, from one wait to the next; all
 * work at one instant, with your hooks; and what of it is outside of steps: samples, outputs,
 * timers, and the choice of the next process. They stay when a run begins.
 */
#define JIWY_PROCESSES 11U
typedef struct jiwy_times {
    uint32_t process[JIWY_PROCESSES];
    uint32_t instant;
    uint32_t kernel;
} jiwy_times;

/* A communication. Channels have numbers, first the ports, in the order of the text; so do
 * processes, from 1, and 0 is the environment. jiwy_channel_name and
 * jiwy_process_name say which they are.
 */
typedef enum jiwy_port {
    JIWY_PORT_JOYSTICK_HORIZONTAL,
    JIWY_PORT_JOYSTICK_VERTICAL,
    JIWY_PORT_JOYSTICK_BUTTONS,
    JIWY_PORT_FEEDBACK_HORIZONTAL,
    JIWY_PORT_FEEDBACK_VERTICAL,
    JIWY_PORT_CONTROL_HORIZONTAL,
    JIWY_PORT_CONTROL_VERTICAL
} jiwy_port;

typedef struct jiwy_communication {
    int64_t instant;
    uint32_t channel;
    uint32_t writer;
    uint32_t reader;
    const void *value; /* of the type of the channel; valid during the call */
    size_t size;
} jiwy_communication;

/* Why a run has failed. What is not known, or does not apply, is NULL. */
typedef enum jiwy_cause {
    JIWY_CAUSE_FAULT,     /* of a computation, or of a device */
    JIWY_CAUSE_TIMEOUT,   /* a sample was overwritten untaken */
    JIWY_CAUSE_EXCEPTION, /* which the program has declared */
    JIWY_CAUSE_DEADLOCK   /* nothing can continue it */
} jiwy_cause;
typedef struct jiwy_failure {
    jiwy_cause cause;
    int64_t instant;
    uint32_t number;       /* of the process; 0: none */
    const char *process;   /* its name in the program, */
    const char *inner;     /* the process below it that the optimizer has inlined, */
    const char *law;       /* and the control law in that */
    const char *place;     /* in the text of the program: "tank.csp:12" */
    const char *exception; /* its name */
} jiwy_failure;

/* What may change while the program runs. */
typedef struct jiwy_parameters jiwy_parameters;

/* What the program asks of you. `context` is passed to all functions. */
typedef struct jiwy_hooks {
    void *context;
    /* Whether time passes by itself. Then a tick that is followed by another one up to the instant
     * of jiwy_advance is a missed sample, because nobody has looked. Otherwise every tick is
     * executed in its turn, however long the steps are.
     */
    bool real_time;
    /* The parameters with which it begins; NULL: those of the text. */
    const jiwy_parameters *parameters;
    /* Stores the sample of this input in its member of `inputs`; false: there is no new one. */
    bool (*sample)(void *context, jiwy_input input, jiwy_inputs *inputs);
    /* Stores the value of this event, of the type that its function has; false: it has not
     * occurred. Asked at each multiple of `grid`, first at `grid` itself, before samples are taken.
     * NULL: events come by their functions only.
     */
    bool (*poll)(void *context, jiwy_event event, void *value);
    /* Nanoseconds; 0 or less: the greatest common divisor of the periods, or 1 ms. */
    int64_t grid;
    /* Hands this output over. `safe`: it is its safe value, and its last. */
    void (*actuate)(void *context, jiwy_output output, const jiwy_outputs *outputs, bool safe);
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
    jiwy_times *times;
    /* If sources are compiled with -DCSP_TRACE_HOOK=1: each communication of a port, and of each
     * channel that the optimizer has left, when its value has been passed. May be NULL.
     */
    void (*trace)(void *context, const jiwy_communication *communication);
    /* The run has failed: jiwy_diagnose says why. Safe values are handed over next. May be
     * NULL.
     */
    void (*fault)(void *context, const jiwy_instance *self);
} jiwy_hooks;

typedef enum jiwy_state {
    JIWY_MORE,     /* everything up to the instant is done */
    JIWY_BUDGET,   /* the steps are used up, and something is still due: call again */
    JIWY_REFUSED,  /* nothing was done: the instant is past or too far, or nothing runs */
    /* The run is over, and the outputs have their safe values: */
    JIWY_ENDED,    /* by itself */
    JIWY_FAILED,   /* by an exception or a fault */
    JIWY_DEADLOCK, /* nothing can continue it */
    JIWY_STOPPED   /* by jiwy_stop */
} jiwy_state;

/* Begins a run. In memory that has an instance already this is a reset, which hands over safe
 * values first; no event function may run meanwhile. If something is wrong it does nothing, returns
 * NULL, and says what it is in `*reason`, which is NULL otherwise; `reason` may be NULL.
 */
jiwy_instance *jiwy_begin(void *memory, size_t size, const jiwy_hooks *hooks, const char **reason);

/* Runs everything that is due up to the instant, with at most this number of steps of processes.
 * Never waits. The last instant of any run is 9223372036 s, after 292 years.
 */
jiwy_state jiwy_advance(jiwy_instance *self, int64_t until, uint32_t steps);

/* Whether the run continues after this result of jiwy_advance. */
static inline bool jiwy_continues(jiwy_state state)
{
    return (state == JIWY_MORE) || (state == JIWY_BUDGET);
}

/* The parameters with the values of the text. */
void jiwy_defaults(jiwy_parameters *parameters);

/* The present parameters. */
void jiwy_get(const jiwy_instance *self, jiwy_parameters *parameters);

/* Changes the parameters, between two steps: from the next instant on, everything uses them.
 * False: nothing was done. Values of enums are not tested, here and in events.
 */
bool jiwy_set(jiwy_instance *self, const jiwy_parameters *parameters);

/* The parameters, and constants that follow from them. */
typedef enum jiwy_parameter {
    JIWY_PARAMETER_PAN_GAINS,
    JIWY_PARAMETER_TILT_GAINS
} jiwy_parameter;

typedef enum jiwy_refusal {
    JIWY_REFUSAL_NONE,
    JIWY_REFUSAL_NOT_FINITE,  /* the parameter, or a part of it, is no finite number */
    JIWY_REFUSAL_NOT_COMPUTED /* this constant could not be computed, or is not finite */
} jiwy_refusal;

/* Why the last jiwy_set did nothing, and because of which parameter, unless that is NULL. */
jiwy_refusal jiwy_why_refused(const jiwy_instance *self, jiwy_parameter *parameter);

/* The next instant at which something is due; INT64_MAX, to which no run advances: nothing but
 * events, so wait for one.
 */
int64_t jiwy_next(jiwy_instance *self);

/* Hands over what the outputs have for this instant, up to which everything is done, before
 * jiwy_advance takes its samples: for simulators that exchange values between steps.
 */
void jiwy_hand_over(jiwy_instance *self, int64_t instant);

/* Ends the run, and hands over safe values. */
void jiwy_finish(jiwy_instance *self);

/* Hands over safe values now, and nothing after them: for fault handlers. If they return, the next
 * jiwy_advance to an instant that is not past ends the run: it answers
 * JIWY_STOPPED. */
void jiwy_release(jiwy_instance *self);

/* Makes the run end at its next step. May be called from anywhere. */
void jiwy_stop(jiwy_instance *self);

/* Copies the state into memory for one instance. The copy has no pointers: it may be kept in a file
 * or in flash. What pointers of structs by hand point to, outside of the instance, is not copied:
 * it has to be a static object, a function or a text of the program. Of memory that has no instance
 * there is nothing to restore.
 */
void jiwy_save(const jiwy_instance *self, jiwy_memory *copy);

/* Continues from a copy of this or another instance, also of an earlier run of this image, at the
 * instant at which it was made. Hooks stay, but for `grid`, and events that have not occurred yet
 * are lost. No event function may run meanwhile. False: the copy is damaged or of another image,
 * and nothing was done.
 */
bool jiwy_restore(jiwy_instance *self, const jiwy_memory *copy);

/* Writes what has failed and where, or which processes wait for what; in a fault handler of the
 * processor, which process was running. At most `size` characters, including the terminating 0.
 */
void jiwy_describe(jiwy_instance *self, char *text, size_t size);

/* Why the run has failed, without a text; false: it has not. */
bool jiwy_diagnose(const jiwy_instance *self, jiwy_failure *failure);

/* The name of a channel or port, and of a process; "" if there is none of this number, or sources
 * are compiled without -DCSP_TRACE_HOOK=1.
 */
const char *jiwy_channel_name(uint32_t channel);
const char *jiwy_process_name(uint32_t process);

/* Writes the longest times, part by part, as JSON for `cspdiag verify --timing --wcet-from`, if
 * sources are compiled with -DCSP_MEASURE=1; `hertz` is the frequency of the counter. Nothing is
 * written for a frequency of 0.
 */
void jiwy_write_times(const jiwy_times *times, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context);

/* Events. Each function may be called from anywhere; the event occurs at the next step, and of
 * several before it the last counts. True: one before it has not been read, and is lost unless it
 * is read in the present step. The function of a port whose name another function or type has
 * ends in a number: jiwy_stop_2.
 */
bool jiwy_joystick_buttons(jiwy_instance *self, int64_t value);

#ifdef __cplusplus
}
#endif

#endif
