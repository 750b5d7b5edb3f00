/* SPDX-License-Identifier: 0BSD */
#include "spindle.h"

#include "csp_arithmetic.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    READS_PANEL = 1,
    INTERRUPTIBLE_REPEAT_LAW,
    READS_FEEDBACK,
    FAILS,
    REPEAT_LAW_READS_FEEDBACK,
    REPEAT_LAW_FAILS
};

static csp_party *spindle_repeat_law_step(csp_kernel *csp, csp_party *party)
{
    struct spindle *const self = CSP_ENCLOSING(party, struct spindle, repeat_law_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        for (;;) {
            /* law (emergency.csp:36) */
            CSP_AWAIT(csp_sampled_read(csp, party, &self->feedback, &self->law.feedback,
                    sizeof(self->law.feedback)),
                csp_sampled_read_again(csp, party, &self->feedback, &self->law.feedback,
                    sizeof(self->law.feedback)),
                REPEAT_LAW_READS_FEEDBACK, fails)
            spindle_controller_calculate(csp, &self->law);
            if (csp_raised_in(csp, party, "law", "emergency.csp:8")) {
                goto fails;
            }
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->law.control,
                sizeof(self->law.control));
        }
    case REPEAT_LAW_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place spindle_repeat_law_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "emergency.csp:17"},
    [REPEAT_LAW_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = REPEAT_LAW_FAILS,
        .where = "emergency.csp:8",
        .inner = "law",
        .offset = offsetof(struct spindle, feedback)
    },
    [REPEAT_LAW_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = REPEAT_LAW_FAILS,
        .where = "emergency.csp:17"
    }
};

static const csp_class spindle_repeat_law_class = {
    .step = spindle_repeat_law_step,
    .places = spindle_repeat_law_places,
    .name = "Spindle",
    .where = "emergency.csp:17",
    .offset = offsetof(struct spindle, repeat_law_branch),
    .states = CSP_STATES(spindle_repeat_law_places)
};

static csp_party *spindle_step(csp_kernel *csp, csp_party *party)
{
    struct spindle *const self = CSP_ENCLOSING(party, struct spindle, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        do {
            /* panel ? button (emergency.csp:34) */
            CSP_AWAIT(csp_event_read(csp, party, self->panel, &self->button, sizeof(self->button)),
                csp_event_read_again(csp, party, self->panel, &self->button, sizeof(self->button)),
                READS_PANEL, fails)
        } while (self->button != EMERGENCY_BUTTON_START);
        /* brake ! false (emergency.csp:35) */
        self->sent.brake = false;
        if (csp_refused(csp, party)) {
            goto fails;
        }
        (void)csp_latched_write(party, self->brake, &self->sent.brake, sizeof(self->sent.brake));
        /* (mu law) interrupt panel ? button -> (control ! 0<V> ; br... (emergency.csp:36) */
        csp_interrupt_prepare(&self->interrupt_repeat_law);
        csp_guard_read(&self->interrupt_repeat_law.alternative, 0U, &self->panel->medium,
            &self->button, sizeof(self->button));
        CSP_AWAIT(csp_interruptible(csp, party, &self->interrupt_repeat_law),
            csp_interruptible_again(csp, party, &self->interrupt_repeat_law),
            INTERRUPTIBLE_REPEAT_LAW, fails)
        if (self->interrupt_repeat_law.taken) {
            /* panel ? button (emergency.csp:36) */
            /* control ! 0<V> (emergency.csp:36) */
            self->sent.control = 0.0;
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->sent.control,
                sizeof(self->sent.control));
            /* brake ! true (emergency.csp:36) */
            self->sent.brake = true;
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->brake, &self->sent.brake,
                sizeof(self->sent.brake));
        }
        do {
            /* feedback ? speed (emergency.csp:37) */
            CSP_AWAIT(csp_sampled_read(csp, party, &self->feedback, &self->speed,
                    sizeof(self->speed)),
                csp_sampled_read_again(csp, party, &self->feedback, &self->speed,
                    sizeof(self->speed)),
                READS_FEEDBACK, fails)
        } while (!(self->speed < 1.0));
        /* halted ! true (emergency.csp:38) */
        self->sent.halted = true;
        if (csp_refused(csp, party)) {
            goto fails;
        }
        (void)csp_direct_write(csp, party, self->halted, &self->sent.halted,
            sizeof(self->sent.halted));
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    case FAILS:
    fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place spindle_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "emergency.csp:17"},
    [READS_PANEL] = {
        .waiting = CSP_AT_READ,
        .indirect = true,
        .failed = FAILS,
        .where = "emergency.csp:34",
        .offset = offsetof(struct spindle, panel)
    },
    [INTERRUPTIBLE_REPEAT_LAW] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = FAILS,
        .where = "emergency.csp:36",
        .offset = offsetof(struct spindle, interrupt_repeat_law)
    },
    [READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = FAILS,
        .where = "emergency.csp:37",
        .offset = offsetof(struct spindle, feedback)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "emergency.csp:17"}
};

static const csp_class spindle_class = {
    .step = spindle_step,
    .places = spindle_places,
    .name = "Spindle",
    .where = "emergency.csp:17",
    .offset = 0,
    .states = CSP_STATES(spindle_places)
};

void spindle_initialize(struct spindle *self, csp_numbers *numbers,
    const struct spindle_ports *ports)
{
    csp_process_init(&self->process, &spindle_class, numbers->process);
    numbers->process++;
    self->control = ports->control;
    self->brake = ports->brake;
    self->halted = ports->halted;
    self->button = EMERGENCY_BUTTON_NONE;
    self->panel = csp_event_reader(&self->panel_latch, ports->panel);
    csp_sampled_end_init(&self->feedback, ports->feedback, &self->samples);
    spindle_controller_initialize(&self->law, 200.0);
    csp_process_init(&self->repeat_law_branch, &spindle_repeat_law_class,
        self->process.party.number);
    csp_interrupt_init(&self->interrupt_repeat_law,
        (uint32_t)offsetof(struct spindle, repeat_law_branch));
}
