/* SPDX-License-Identifier: 0BSD */
/* The internal interface of the kernel; not for generated code. */
#ifndef CSP_INTERNAL_H
#define CSP_INTERNAL_H

#include "csp.h"
#include "csp_shared.h"

/* ---- Scheduler ---- */

/* Runs ready processes until none is left, or the steps are used up, which it counts down. Returns whether one is still ready. */
bool csp_run_ready(csp_kernel *csp, uint32_t *steps);
/* Whether a process is ready. */
bool csp_is_ready(csp_kernel *csp);
/* Takes a party out of the ready queue. */
void csp_unready(csp_kernel *csp, csp_party *party);

/* ---- Execution times ---- */

#if CSP_MEASURE
/* To be called around each step, from one choice of the scheduler to the next, and before each process in it. */
void csp_measure_begin(csp_kernel *csp);
void csp_measure_party(csp_kernel *csp, uint32_t number);
void csp_measure_end(csp_kernel *csp);
#else
static inline void csp_measure_begin(csp_kernel *csp)
{
    (void)csp;
}

static inline void csp_measure_party(csp_kernel *csp, uint32_t number)
{
    (void)csp;
    (void)number;
}

static inline void csp_measure_end(csp_kernel *csp)
{
    (void)csp;
}
#endif

#if CSP_MEASURE && !CSP_TRACE
/* To be called around the work at an instant, which may be in parts; `done`: this was the last one. */
void csp_measure_enter(csp_kernel *csp);
void csp_measure_leave(csp_kernel *csp, bool done);
#else
static inline void csp_measure_enter(csp_kernel *csp)
{
    (void)csp;
}

static inline void csp_measure_leave(csp_kernel *csp, bool done)
{
    (void)csp;
    (void)done;
}
#endif

/* ---- Queues of parties in channels ---- */

void csp_enter_front(csp_queue *queue, csp_party *party);
/* Returns false if the party was not in the queue. */
bool csp_remove(csp_queue *queue, const csp_party *party);
bool csp_contains(const csp_queue *queue, const csp_party *party);

/* ---- Places ---- */

CSP_COLD const csp_place *csp_place_of(const csp_process *process);
/* The object of a place: a channel, a parallel... */
void *csp_object_at(const csp_process *process, const csp_place *place);
/* Withdraws a party from where it waits. Returns false if it no longer waits there. */
bool csp_withdraw(csp_medium *medium, csp_party *party);
/* Whether a party waits at a medium. */
bool csp_is_registered(const csp_medium *medium, const csp_party *party);
/* Withdraws a process from whatever it waits for at its place. */
bool csp_withdraw_process(csp_kernel *csp, csp_process *process);

/* ---- Parallel and cancellation ---- */

/* The process whose branch this one is, or that called it; NULL for the outermost process. */
static inline csp_process *csp_parent_of(const csp_process *process)
{
    if ((process->party.flags & (unsigned)CSP_BRANCH) != 0U) {
        return ((const csp_parallel *)process->above)->parent;
    }
    return (csp_process *)process->above;
}

/* Cancels a branch and everything below it. `interrupt` is needed if the running process may be among them. */
void csp_cancel(csp_kernel *csp, csp_process *branch, csp_interrupt *interrupt);
/* The next branch of a walk over the branches of a parallel; NULL: no more. */
csp_process *csp_next_branch(csp_parallel *parallel);
/* The outermost process of the task whose innermost process is `process`. */
csp_process *csp_task_of(csp_process *process);
/* The parallel at which the process waits, or that of the interrupt; NULL: neither. */
csp_parallel *csp_parallel_of(const csp_process *process);

/* ---- Timers ---- */

/* The instant after a duration from now; if it is beyond the end of time, one that no run reaches. */
int64_t csp_after(csp_kernel *csp, int64_t duration);
void csp_timer_begin(csp_kernel *csp, csp_timer *timer, int64_t instant);
/* Returns false if the timer was not running. */
bool csp_timer_stop(csp_kernel *csp, csp_timer *timer);
/* The instant of the earliest timer; INT64_MAX: none. */
static inline int64_t csp_timer_next(csp_kernel *csp)
{
    return (csp->earliest == NULL) ? INT64_MAX : csp->earliest->instant;
}
void csp_timers_fall_due(csp_kernel *csp, int64_t instant);

/* ---- Guards ---- */

/* Begin and end keeping the bit of a guard up to date. */
void csp_watch(csp_guard **watchers, csp_guard *guard);
void csp_unwatch(csp_guard **watchers, csp_guard *guard);
/* Requests that the channel of these guards is notified when their alternatives wait. */
void csp_attend(csp_kernel *csp, csp_guard *watchers);
void csp_set_attends(csp_guard *guard, bool attends);
bool csp_is_enabled(const csp_guard *guard);
/* Whether an alternative waits for one of these guards. */
bool csp_awaited(const csp_guard *watchers);
/* To be called when the other side has chosen the guard and has communicated. */
void csp_resolve(csp_kernel *csp, csp_guard *guard);
/* The other side has chosen this output guard and is going to read. Returns the party that waits for that in the channel. */
csp_party *csp_pledge(csp_kernel *csp, csp_guard *guard);
bool csp_alternative_withdraw(csp_kernel *csp, csp_alternative *alternative, csp_party *party);
void csp_end_waiting(csp_kernel *csp, csp_alternative *alternative);
void csp_begin_waiting(csp_kernel *csp, csp_party *party, csp_alternative *alternative);
/* Whether time-outs with a duration of zero have passed. */
bool csp_time_outs_passed(csp_alternative *alternative);

/* Operations of media on guards, by kind of medium. */
void csp_watch_input(csp_kernel *csp, csp_guard *guard);
void csp_watch_output(csp_kernel *csp, csp_guard *guard);
void csp_unwatch_guard(csp_guard *guard);
void csp_enroll(csp_kernel *csp, csp_guard *guard);
void csp_dismiss(csp_guard *guard);
csp_progress csp_take(csp_kernel *csp, csp_party *party, csp_guard *guard);
void csp_settle_input(csp_kernel *csp, csp_guard *guard);
csp_progress csp_choose_output(csp_kernel *csp, csp_party *party, csp_guard *guard);

/* ---- Media ---- */

csp_progress csp_any_take(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size);
void csp_any_settle(csp_kernel *csp, csp_any_channel *channel);
csp_progress csp_any_choose_output(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size);
void csp_any_left(csp_any_channel *channel);
void csp_buffer_take(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size);
void csp_broadcast_taken(csp_kernel *csp, csp_party *party, csp_broadcast_end *end, void *value, size_t size);
csp_progress csp_broadcast_choose_output(csp_kernel *csp, csp_party *party, csp_broadcast *channel, void *value, size_t size);
void csp_broadcast_readers_changed(csp_kernel *csp, const csp_broadcast *channel);
/* To be called when a reader has been withdrawn; never wakes a process. */
void csp_broadcast_reader_left(const csp_broadcast *channel);
void csp_broadcast_recall(const csp_broadcast *channel);
csp_progress csp_sampled_take(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size);
void csp_sampled_begin(csp_sampled_end *end);
void csp_event_take(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size);
/* A reader was made ready but cancelled before it ran: passes the event on to the next reader. */
void csp_event_pass_on(csp_kernel *csp, csp_event_end *end);

/* ---- Offers, interrupts, ports ---- */

bool csp_offers_withdraw(csp_kernel *csp, csp_offers *offers);
bool csp_interrupt_withdraw(csp_kernel *csp, csp_interrupt *interrupt, csp_party *party);
/* To be called when the guard has become ready, or was chosen by the other side. */
void csp_interrupt_wake(csp_kernel *csp, csp_interrupt *interrupt);
/* Whether its body has ended and its process waits for the communication of the guard. */
bool csp_interrupt_waits(const csp_interrupt *interrupt);
void csp_interrupt_retract(csp_kernel *csp, csp_interrupt *interrupt);
/* To be called when a branch of the body has ended, in whatever way. */
void csp_body_ended(csp_kernel *csp, csp_interrupt *interrupt, bool cancelled);
void csp_sampled_tick(csp_kernel *csp, csp_sampled_input *port);
/* A tick that is past when the next one is, too: the device is not read. */
void csp_sampled_skip(csp_sampled_input *port, int64_t ticks);
void csp_event_poll(csp_kernel *csp, csp_event_input *port);
void csp_latched_tick(csp_kernel *csp, csp_latched_output *output);
bool csp_sampled_can_come(const csp_sampled_input *port);
/* Whether an event may still occur; `interrupts`: interrupt handlers may bring events. */
bool csp_event_can_come(const csp_event_input *port, bool interrupts);

/* ---- Runs ---- */

/* To be called when an interrupt handler has brought an event. */
void csp_announce_event(csp_kernel *csp);

/* Determines the ports that have instants. */
void csp_instants_begin(csp_kernel *csp);
/* Executes this tick; `present` is the time that has already passed. Returns false if the environment has failed. */
bool csp_ticks_meet(csp_kernel *csp, int64_t instant, int64_t present);

/* Hands over the latched outputs whose tick this is. */
void csp_outputs_meet(csp_kernel *csp, int64_t instant);

/* The next instant of a tick or a timer; INT64_MAX: none. */
static inline int64_t csp_instants_next(csp_kernel *csp)
{
    const int64_t timer = csp_timer_next(csp);
    return (csp->next_tick < timer) ? csp->next_tick : timer;
}

/* Executes an instant, as csp_ticks_meet. */
static inline bool csp_instants_meet(csp_kernel *csp, int64_t instant, int64_t present)
{
    csp->now = instant;
    if ((instant == csp->next_tick) && !csp_ticks_meet(csp, instant, present)) {
        return false;
    }
    csp_timers_fall_due(csp, instant);
    return true;
}
/* To be called before the run: from then on the outputs have to be released. */
void csp_begin_driving(csp_kernel *csp);

/* Call device functions. After the outputs have been released, writes are ignored. */
static inline bool csp_device_read(csp_kernel *csp, const csp_medium *port, const csp_driver *driver, void *value)
{
    CSP_NOTE(csp->called, port);
    const bool came = driver->read(driver->device, value);
    CSP_NOTE(csp->called, NULL);
    return came;
}

static inline void csp_device_write(csp_kernel *csp, const csp_medium *port, const csp_driver *driver, const void *value)
{
    if ((driver->write != NULL) && !CSP_LOAD(csp->closed)) {
        CSP_NOTE(csp->called, port);
        driver->write(driver->device, value);
        CSP_NOTE(csp->called, NULL);
    }
}

/* The calls of device functions in progress, as another thread sees them. */
typedef struct csp_calls {
    bool driving;               /* there are outputs that are not released */
    const csp_medium *port;     /* the port whose device function is being called; NULL: none */
    bool releases;              /* safe values are being written, to `released` ports so far */
    uint32_t released;
} csp_calls;

csp_calls csp_calls_now(csp_kernel *csp);

#endif
