/* See csp_sweep_measures.h. */
#include "csp_sweep_measures.h"

#include <math.h>
#include <stdlib.h>

#include "csp_arithmetic.h"

typedef struct signal {
    csp_sweep_signal is;
    double value; /* NAN: none yet */
} signal;

typedef struct measure {
    csp_sweep_measure is;
    bool changed;  /* at the present instant */
    int64_t since; /* the instant of the value; negative: none yet */
    int64_t first; /* that of the first value */
    double value;
    double result; /* of max, min, peak, mean, ..., as far as it is known */
    double begun;  /* overshoot: the first value; settling: when it came within the tolerance; NAN: it is not */
} measure;

static signal *signals;
static uint32_t signal_count;
static measure *measures;
static uint32_t measure_count;
static int64_t observed_at; /* the instant of the last observation */

bool csp_sweep_make_measures(const csp_sweep_signal *of, uint32_t observed, const csp_sweep_measure *wanted, uint32_t count)
{
    signals = calloc(observed + 1U, sizeof *signals);
    measures = calloc(count + 1U, sizeof *measures);
    if ((signals == NULL) || (measures == NULL)) {
        return false;
    }
    signal_count = observed;
    measure_count = count;
    for (uint32_t index = 0; index < observed; index++) {
        signals[index].is = of[index];
    }
    for (uint32_t index = 0; index < count; index++) {
        measures[index].is = wanted[index];
    }
    return true;
}

static double number_at(const void *place, uint32_t type)
{
    switch (type) {
    case 'd':
        return *(const double *)place;
    case 'f':
        return (double)*(const float *)place;
    case '?':
        return *(const bool *)place ? 1.0 : 0.0;
    case 'b':
        return (double)*(const int8_t *)place;
    case 'B':
        return (double)*(const uint8_t *)place;
    case 'h':
        return (double)*(const int16_t *)place;
    case 'H':
        return (double)*(const uint16_t *)place;
    case 'i':
        return (double)*(const int32_t *)place;
    case 'I':
        return (double)*(const uint32_t *)place;
    case 'Q':
        return (double)*(const uint64_t *)place;
    case 'T':
        return csp_seconds(*(const int64_t *)place);
    default:
        return (double)*(const int64_t *)place;
    }
}

/* What the value that is held until `now` adds to an integral. */
static void hold(measure *self, int64_t now)
{
    const double held = csp_seconds(now - self->since);
    if (held <= 0.0) {
        return; /* not a NaN where the value, or its square, is infinite */
    }
    switch (self->is.kind) {
    case CSP_SWEEP_MEAN:
    case CSP_SWEEP_INTEGRAL:
        self->result += self->value * held;
        break;
    case CSP_SWEEP_RMS:
        self->result += (self->value * self->value) * held;
        break;
    default:
        break; /* only its values count */
    }
}

static void begin(measure *self, int64_t now, double value)
{
    self->first = now;
    switch (self->is.kind) {
    case CSP_SWEEP_PEAK:
        self->result = fabs(value);
        break;
    case CSP_SWEEP_MEAN:
    case CSP_SWEEP_RMS:
    case CSP_SWEEP_INTEGRAL:
        self->result = 0.0;
        break;
    case CSP_SWEEP_OVERSHOOT:
        self->begun = value;
        self->result = 0.0;
        break;
    default:
        self->result = value;
        break;
    }
}

static double beyond(const measure *self, double value)
{
    const double target = self->is.target;
    if (self->begun < target) {
        return value - target;
    }
    return (self->begun > target) ? target - value : fabs(value - target);
}

static void take(measure *self, int64_t now, double value)
{
    if (self->since < 0) {
        begin(self, now, value);
    } else {
        hold(self, now);
    }
    self->since = now;
    self->value = value;
    switch (self->is.kind) {
    case CSP_SWEEP_MAX:
        self->result = (value > self->result) ? value : self->result;
        break;
    case CSP_SWEEP_MIN:
        self->result = (value < self->result) ? value : self->result;
        break;
    case CSP_SWEEP_PEAK:
        self->result = (fabs(value) > self->result) ? fabs(value) : self->result;
        break;
    case CSP_SWEEP_LAST:
        self->result = value;
        break;
    case CSP_SWEEP_SETTLING:
        if (!(fabs(value - self->is.target) <= self->is.tolerance)) {
            self->begun = NAN;
        } else if (isnan(self->begun)) {
            self->begun = csp_seconds(now);
        } else {
            /* It stays. */
        }
        break;
    case CSP_SWEEP_OVERSHOOT:
        self->result = (beyond(self, value) > self->result) ? beyond(self, value) : self->result;
        break;
    default:
        break; /* integrals are taken when it is known how long the value was held */
    }
}

static double finished(measure *self, int64_t end)
{
    if (self->since < 0) {
        return NAN;
    }
    hold(self, end);
    const double length = csp_seconds(end - self->first);
    switch (self->is.kind) {
    case CSP_SWEEP_MEAN:
        return (length > 0.0) ? self->result / length : self->value;
    case CSP_SWEEP_RMS:
        return (length > 0.0) ? sqrt(self->result / length) : fabs(self->value);
    case CSP_SWEEP_SETTLING:
        return self->begun;
    default:
        return self->result;
    }
}

/* Gives measures the values of the instant that is over. */
static void close_instant(void)
{
    for (uint32_t index = 0; index < measure_count; index++) {
        measure *const self = &measures[index];
        if (self->changed) {
            self->changed = false;
            double value = signals[self->is.signal].value;
            if (self->is.subtracted != CSP_SWEEP_NOTHING) {
                value -= signals[self->is.subtracted].value;
            }
            if (!isnan(value)) { /* both are known */
                take(self, observed_at, (self->is.absolute != 0U) ? fabs(value) : value);
            }
        }
    }
}

/* A new instant closes the one before. */
static void reach(int64_t now)
{
    if (now != observed_at) {
        close_instant();
        observed_at = now;
    }
}

static void set(uint32_t index, const void *value)
{
    signal *const self = &signals[index];
    self->value = number_at((const char *)value + self->is.offset, self->is.type);
    for (uint32_t at = 0; at < measure_count; at++) {
        if ((measures[at].is.signal == index) || (measures[at].is.subtracted == index)) {
            measures[at].changed = true;
        }
    }
}

void csp_sweep_observe_port(int64_t now, uint32_t port, const void *value)
{
    reach(now);
    for (uint32_t index = 0; index < signal_count; index++) {
        if ((signals[index].is.state == 0U) && (signals[index].is.number == port)) {
            set(index, value);
        }
    }
}

void csp_sweep_observe_states(const csp_sweep *sweep, int64_t now)
{
    reach(now);
    for (uint32_t index = 0; index < signal_count; index++) {
        if (signals[index].is.state != 0U) {
            const size_t place = sweep->states[signals[index].is.number];
            set(index, (const char *)sweep->environment->state + place);
        }
    }
}

void csp_sweep_begin_measures(void)
{
    observed_at = 0;
    for (uint32_t index = 0; index < signal_count; index++) {
        signals[index].value = NAN;
    }
    for (uint32_t index = 0; index < measure_count; index++) {
        measures[index] = (measure){.is = measures[index].is, .since = -1, .begun = NAN};
    }
}

void csp_sweep_end_measures(void)
{
    close_instant();
}

double csp_sweep_measured(uint32_t index, int64_t end)
{
    return finished(&measures[index], end);
}
