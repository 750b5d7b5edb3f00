/* SPDX-License-Identifier: 0BSD */
/* See spindle_controller.h. */
#include "spindle_controller.h"

#include "csp_arithmetic.h"

void spindle_controller_initialize(struct spindle_controller *self, double speed)
{
    self->speed = speed;
    spindle_controller_reset(self);
}

void spindle_controller_reset(struct spindle_controller *self)
{
    (void)self;
}

void spindle_controller_calculate(csp_kernel *csp, struct spindle_controller *self)
{
    /* emergency.csp:12 */
    self->control = csp_real(csp,
        csp_limit(0.05 * self->feedback + 0.5 * (self->speed - self->feedback), -24.0, 24.0));
    csp_fault_in(csp, "emergency.csp:12");
}
