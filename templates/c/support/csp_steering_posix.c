/* SPDX-License-Identifier: 0BSD */
/* See csp_steering.h. */
#define _POSIX_C_SOURCE 200809L /* poll */

#include "csp_steering.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "csp_internal.h"
#include "csp_port.h"
#include "csp_shared.h"
#include "csp_simulation_host.h"
#include "csp_stream.h"
#include "csp_watch.h"

/* The steps of processes, and the instants, between two looks for an order to pause; milliseconds between two looks for other requests. */
enum { STEPS = 256, TURNS = 16, INTERVAL = 50 };

/* Nanoseconds between two reports of a run in real time: half of those between two pictures. */
#define BETWEEN_REPORTS INT64_C(8000000)

/* An input that is taken over. */
typedef struct override {
    struct override *other;
    uint32_t port;
    uint32_t size;
    unsigned char value[];
} override;

static int64_t orders = -1; /* the descriptor */
static override *overrides;
static csp_environment steered;     /* that of the program, with overrides */
static const csp_environment *own;  /* without them */
static csp_ending state;            /* CSP_MORE: all that is left to do is later; CSP_BUDGET: there is more at this instant */

bool csp_steering_open(const char *text)
{
    return csp_read_number(text, &orders);
}

bool csp_is_steered(void)
{
    return orders >= 0;
}

/* ---- Orders ---- */

static bool has_order(int wait)
{
    struct pollfd source = {(int)orders, POLLIN, 0};
    return poll(&source, 1U, wait) > 0;
}

/* Reads what is on its way. Returns false if the other end is closed. */
static bool read_all(void *into, size_t size)
{
    unsigned char *const place = into;
    size_t done = 0U;
    while (done < size) {
        const ssize_t count = read((int)orders, &place[done], size - done);
        if (count > 0) {
            done += (size_t)count;
        } else if ((count == 0) || (errno != EINTR)) {
            return false;
        } else {
            /* A signal has interrupted it. */
        }
    }
    return true;
}

static bool runs(void)
{
    return (state == CSP_MORE) || (state == CSP_BUDGET);
}

/* Waits for the next order; without one the run ends. Meanwhile changes of parameters are read, so that their pipe does not become full. */
static void next_order(csp_kernel *csp, csp_order *order)
{
    const csp_tuning *const tuning = csp->program->tuning;
    while (!CSP_LOAD(csp->stop_requested) && !has_order(INTERVAL)) {
        if (tuning != NULL) {
            (void)tuning->next();
        }
    }
    if (CSP_LOAD(csp->stop_requested) || !read_all(order, sizeof *order)) {
        state = CSP_STOPPED;
    }
}

/* ---- Inputs that are taken over ---- */

static void *device_at(csp_kernel *csp, uint32_t number)
{
    const csp_program *const program = csp->program;
    void *device = NULL;
    if (number < program->port_count) {
        const csp_port *const port = &program->ports[number];
        void *const medium = csp_medium_of(csp, port);
        if (port->kind == CSP_PORT_SAMPLED) {
            device = ((const csp_sampled_input *)medium)->driver.device;
        } else if (port->kind == CSP_PORT_EVENT) {
            device = ((const csp_event_input *)medium)->driver.device;
        } else {
            /* Outputs are those of the program. */
        }
    }
    return device;
}

static void give_back(uint32_t port)
{
    for (override **place = &overrides; *place != NULL; place = &(*place)->other) {
        override *const found = *place;
        if (found->port == port) {
            *place = found->other;
            free(found);
            return;
        }
    }
}

static void take(csp_kernel *csp, const csp_order *order)
{
    override *const taken = malloc(sizeof *taken + order->size);
    if ((taken == NULL) || !read_all(taken->value, order->size)) {
        free(taken);
        csp_request_stop(csp);
        return;
    }
    give_back(order->number);
    taken->port = order->number;
    taken->size = order->size;
    taken->other = overrides;
    overrides = taken;
}

static bool advance_with_overrides(csp_kernel *csp, void *of, int64_t now)
{
    if ((own->advance != NULL) && !own->advance(csp, of, now)) {
        return false;
    }
    for (const override *each = overrides; each != NULL; each = each->other) {
        void *const device = device_at(csp, each->port);
        if (device != NULL) {
            (void)memcpy(device, each->value, each->size);
        }
    }
    return true;
}

static void allow_overrides(csp_program *program)
{
    own = program->environment;
    if (own != NULL) {
        steered = *own;
        steered.advance = advance_with_overrides;
        program->environment = &steered;
    }
}

/* Says that it waits for an order, or has carried one out. */
static void hold(csp_kernel *csp, bool reached)
{
    csp_stream_held(csp, reached, csp_next(csp));
}

/* Carries out an order other than those to advance. */
static void carry_out(csp_kernel *csp, const csp_order *order)
{
    switch (order->kind) {
    case CSP_TAKE:
        take(csp, order);
        break;
    case CSP_GIVE_BACK:
        give_back(order->number);
        break;
    case CSP_REPORT:
        csp_stream_waiting(csp);
        hold(csp, true);
        break;
    default:
        break; /* to pause, what is over */
    }
}

/* ---- In virtual time ---- */

/* Whether there is an order to pause, or nobody is there any more. Of the others only those about
 * inputs come while the run advances. */
static bool is_to_pause(csp_kernel *csp)
{
    while (has_order(0)) {
        csp_order order;
        if (!read_all(&order, sizeof order)) {
            csp_request_stop(csp);
            return true;
        }
        if (order.kind == (uint32_t)CSP_PAUSE) {
            return true;
        }
        carry_out(csp, &order);
    }
    return false;
}

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

/* Advances instant by instant. Returns whether nothing is left to do up to that of the order. */
static bool advance(csp_kernel *csp, const csp_order *order, int64_t last)
{
    const csp_tuning *const tuning = csp->program->tuning;
    const bool single = order->kind == (uint32_t)CSP_STEP;
    const uint64_t before = csp_stream_communications();
    for (uint32_t turn = 1U; runs(); turn++) {
        const int64_t next = csp_next(csp);
        if (single && ((csp_stream_communications() - before) >= order->number)) {
            return false;
        }
        if ((state == CSP_MORE) && (next > earlier(order->instant, last))) {
            return true;
        }
        if ((turn % (uint32_t)TURNS == 0U) && is_to_pause(csp)) {
            return false;
        }
        if ((state == CSP_MORE) && (tuning != NULL)) { /* before everything else at this instant */
            tuning->make(csp, next);
        }
        state = csp_advance(csp, next, single ? 1U : (uint32_t)STEPS);
    }
    return true;
}

static void follow(csp_kernel *csp, const csp_order *order, int64_t last)
{
    if ((order->kind != (uint32_t)CSP_ADVANCE) && (order->kind != (uint32_t)CSP_STEP)) {
        carry_out(csp, order);
        return;
    }
    const bool reached = advance(csp, order, last);
    if (runs() && reached && (order->instant >= last)) {
        state = CSP_TIME_LIMIT;
        csp->now = last;
    } else if (runs()) {
        csp->now = (reached && (order->instant > csp->now)) ? order->instant : csp->now;
        hold(csp, reached);
    } else {
        /* The end is reported. */
    }
}

static csp_ending run_in_virtual_time(csp_kernel *csp, int64_t last)
{
    csp_own(csp);
    state = csp_begin(csp);
    if (state == CSP_NOT_INITIALIZED) {
        return state;
    }
    if (state == CSP_MORE) {
        csp_port_start();
        state = CSP_BUDGET;
        hold(csp, true);
    }
    while (runs()) {
        csp_order order = {0, 0U, 0U, 0U, 0U};
        next_order(csp, &order);
        if (runs()) {
            follow(csp, &order, last);
        }
    }
    csp_finish(csp);
    csp_port_finish(csp);
    return state;
}

/* ---- In real time ---- */

static csp_kernel *paced;
static const csp_tuning *changes; /* of parameters; NULL: none */
static int64_t reported = -1;     /* the instant of the last report; negative: there was none */

/* Says how far it is, and sends what has happened, without waiting for the reader. */
static void report(void)
{
    const int64_t present = paced->reached;
    paced->now = (present > paced->now) ? present : paced->now; /* nothing is due before it */
    if (reported < 0) {
        hold(paced, true);
        reported = present;
    } else if ((present - reported) >= BETWEEN_REPORTS) {
        csp_stream_present(paced);
        csp_watch_attend(false);
        reported = present;
    } else {
        /* Later, together with more. */
    }
}

/* What csp_run asks when all processes wait: orders are carried out then, too. */
static int64_t next_change(void)
{
    while (!CSP_LOAD(paced->stop_requested) && has_order(0)) {
        csp_order order;
        if (read_all(&order, sizeof order)) {
            carry_out(paced, &order);
        } else {
            csp_request_stop(paced);
        }
    }
    report();
    return (changes != NULL) ? changes->next() : INT64_MAX;
}

static void make_changes(csp_kernel *csp, int64_t instant)
{
    if (changes != NULL) {
        changes->make(csp, instant);
    }
}

static csp_ending run_in_real_time(csp_kernel *csp, csp_program *program, int64_t until)
{
    static const csp_tuning tuning = {next_change, make_changes};
    changes = program->tuning;
    program->tuning = &tuning;
    paced = csp;
    return csp_run(csp, until);
}

/* ---- The run ---- */

csp_ending csp_run_steered(csp_kernel *csp, int64_t until)
{
    static csp_program program; /* handlers may look at it until the process ends */
    program = *csp->program;
    allow_overrides(&program);
    csp->program = &program;
    if (csp->real_time) {
        return run_in_real_time(csp, &program, until);
    }
    const bool limited = (until >= 0) && (until < CSP_END_OF_TIME);
    return run_in_virtual_time(csp, limited ? until : CSP_END_OF_TIME);
}
