/* SPDX-License-Identifier: 0BSD */
#include "align.h"

#include "csp_arithmetic.h"
#include "types.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    INTERRUPTIBLE_REPEAT_VELOCITY = 1,
    CATCHES_TIMEOUT,
    REPEAT_VELOCITY_READS_FEEDBACK,
    REPEAT_VELOCITY_FAILS
};

static csp_party *align_repeat_velocity_step(csp_kernel *csp, csp_party *party)
{
    struct align *const self = CSP_ENCLOSING(party, struct align, repeat_velocity_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        do {
            /* velocity (jiwy.csp:39) */
            CSP_AWAIT(csp_sampled_read(csp, party, &self->feedback, &self->velocity.feedback,
                    sizeof(self->velocity.feedback)),
                csp_sampled_read_again(csp, party, &self->feedback, &self->velocity.feedback,
                    sizeof(self->velocity.feedback)),
                REPEAT_VELOCITY_READS_FEEDBACK, fails)
            velocity_controller_calculate(csp, &self->velocity);
            if (csp_raised_in(csp, party, "velocity", "laws.csp:88")) {
                goto fails;
            }
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->velocity.control,
                sizeof(self->velocity.control));
            *self->max = self->velocity.max;
            if (self->max_written != NULL) {
                self->max_written->done = true;
            }
            self->stop = self->velocity.stop;
        } while (!self->stop);
        return csp_end(csp, party);
    case REPEAT_VELOCITY_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place align_repeat_velocity_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:23"},
    [REPEAT_VELOCITY_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = REPEAT_VELOCITY_FAILS,
        .where = "laws.csp:88",
        .inner = "velocity",
        .offset = offsetof(struct align, feedback)
    },
    [REPEAT_VELOCITY_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = REPEAT_VELOCITY_FAILS,
        .where = "jiwy.csp:23"
    }
};

static const csp_class align_repeat_velocity_class = {
    .step = align_repeat_velocity_step,
    .places = align_repeat_velocity_places,
    .name = "Align",
    .where = "jiwy.csp:23",
    .offset = offsetof(struct align, repeat_velocity_branch),
    .states = CSP_STATES(align_repeat_velocity_places)
};

static csp_party *align_step(csp_kernel *csp, csp_party *party)
{
    struct align *const self = CSP_ENCLOSING(party, struct align, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        /* (mu velocity until stop) interrupt after patience -> fail... (jiwy.csp:39) */
        csp_interrupt_prepare(&self->interrupt_repeat_velocity);
        csp_guard_after(&self->interrupt_repeat_velocity.alternative, 0U,
            &self->interrupt_repeat_velocity.timer);
        csp_delay(&self->interrupt_repeat_velocity.alternative, 0U, self->patience);
        CSP_AWAIT(csp_interruptible(csp, party, &self->interrupt_repeat_velocity),
            csp_interruptible_again(csp, party, &self->interrupt_repeat_velocity),
            INTERRUPTIBLE_REPEAT_VELOCITY, catches_timeout)
        if (self->interrupt_repeat_velocity.taken) {
            /* after patience (jiwy.csp:39) */
            /* failed := true (jiwy.csp:39) */
            self->failed = true;
        }
        goto after_catches_timeout;
    case CATCHES_TIMEOUT:
    catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto fails;
        }
        /* failed := true (jiwy.csp:39) */
        self->failed = true;
    after_catches_timeout:
        /* control ! 0<V> (jiwy.csp:40) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->failed) {
            /* raise ModeFailed (jiwy.csp:41) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:41");
            goto fails;
        }
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place align_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:23"},
    [INTERRUPTIBLE_REPEAT_VELOCITY] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:39",
        .offset = offsetof(struct align, interrupt_repeat_velocity)
    },
    [CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:39"
    }
};

static const csp_class align_class = {
    .step = align_step,
    .places = align_places,
    .name = "Align",
    .where = "jiwy.csp:23",
    .offset = 0,
    .states = CSP_STATES(align_places)
};

void align_initialize(struct align *self, csp_numbers *numbers, const struct align_ports *ports,
    int64_t T, double speed, double kp, double ki, int64_t patience)
{
    csp_process_init(&self->process, &align_class, numbers->process);
    numbers->process++;
    self->patience = patience;
    self->control = ports->control;
    self->max = ports->max;
    self->max_written = ports->max_written;
    self->failed = false;
    csp_sampled_end_init(&self->feedback, ports->feedback, &self->samples);
    velocity_controller_initialize(&self->velocity, speed, kp, ki, 1.5, 0.9, 20 * CSP_MS,
        100 * CSP_MS, csp_seconds(T));
    csp_process_init(&self->repeat_velocity_branch, &align_repeat_velocity_class,
        self->process.party.number);
    csp_interrupt_init(&self->interrupt_repeat_velocity,
        (uint32_t)offsetof(struct align, repeat_velocity_branch));
}
