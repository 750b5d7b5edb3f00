/* See fmu.h: the values of variables, by value reference. */
#include "fmu.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static bool fail_of_variable(fmu_instance *self, uint32_t reference, const char *problem)
{
    char text[FMU_TEXT] = "";
    const char *const name = (reference < fmu_variable_count) ? fmu_variables[reference].name : "?";
    (void)snprintf(text, sizeof text, "%s (value reference %" PRIu32 ") %s", name, reference, problem);
    return fmu_fail(self, text);
}

static const fmu_variable *variable(fmu_instance *self, uint32_t reference)
{
    if (reference >= fmu_variable_count) {
        (void)fail_of_variable(self, reference, "does not exist");
        return NULL;
    }
    return &fmu_variables[reference];
}

static void *place(fmu_instance *self, const fmu_variable *of)
{
    return (char *)self->model + of->offset;
}

static const fmu_variable *settable(fmu_instance *self, uint32_t reference)
{
    const fmu_variable *const found = variable(self, reference);
    if (found == NULL) {
        return NULL;
    }
    if (found->use == FMU_FIXED) {
        if (self->phase > FMU_INITIALIZING) {
            (void)fail_of_variable(self, reference, "cannot be set any more: it is a fixed parameter, for the initialization");
            return NULL;
        }
    } else if ((found->use != FMU_INPUT) && (found->use != FMU_PARAMETER)) {
        (void)fail_of_variable(self, reference, "cannot be set: it is no input");
        return NULL;
    }
    return found;
}

bool fmu_type_of(fmu_instance *self, uint32_t reference, fmu_type *type)
{
    const fmu_variable *const found = variable(self, reference);
    if (found != NULL) {
        *type = found->type;
    }
    return found != NULL;
}

bool fmu_get_real(fmu_instance *self, uint32_t reference, double *value)
{
    const fmu_variable *const found = variable(self, reference);
    if (found == NULL) {
        return false;
    }
    if (found->use == FMU_INDEPENDENT) {
        *value = fmu_time(self);
    } else if (found->type == FMU_FLOAT64) {
        *value = *(double *)place(self, found);
    } else if (found->type == FMU_FLOAT32) {
        *value = (double)*(float *)place(self, found);
    } else if (found->type == FMU_TIME) {
        *value = (double)*(int64_t *)place(self, found) / FMU_NANOSECONDS;
    } else {
        return fail_of_variable(self, reference, "is no real number");
    }
    return true;
}

bool fmu_set_real(fmu_instance *self, uint32_t reference, double value)
{
    const fmu_variable *const found = settable(self, reference);
    if (found == NULL) {
        return false;
    }
    if ((found->use == FMU_FIXED) && !isfinite(value)) {
        return fail_of_variable(self, reference, "does not have this value: it is not finite");
    }
    if (found->type == FMU_FLOAT64) {
        *(double *)place(self, found) = value;
    } else if (found->type == FMU_FLOAT32) {
        *(float *)place(self, found) = (float)value;
    } else if (found->type == FMU_TIME) {
        if (!(fabs(value) < 9.2e9)) {
            return fail_of_variable(self, reference, "is a time of more than 292 years");
        }
        *(int64_t *)place(self, found) = (int64_t)llrint(value * FMU_NANOSECONDS);
    } else {
        return fail_of_variable(self, reference, "is no real number");
    }
    return true;
}

bool fmu_get_integer(fmu_instance *self, uint32_t reference, int64_t *value)
{
    const fmu_variable *const found = variable(self, reference);
    if (found == NULL) {
        return false;
    }
    const void *const at = place(self, found);
    switch (found->type) {
    case FMU_INT8: *value = *(const int8_t *)at; break;
    case FMU_UINT8: *value = *(const uint8_t *)at; break;
    case FMU_INT16: *value = *(const int16_t *)at; break;
    case FMU_UINT16: *value = *(const uint16_t *)at; break;
    case FMU_INT32: *value = *(const int32_t *)at; break;
    case FMU_UINT32: *value = *(const uint32_t *)at; break;
    case FMU_INT64: *value = *(const int64_t *)at; break;
    case FMU_ENUMERATION: *value = (int64_t)*(const int *)at + 1; break;
    default: return fail_of_variable(self, reference, "is no integer");
    }
    return true;
}

static bool is_in_range(const fmu_variable *of, int64_t value)
{
    switch (of->type) {
    case FMU_INT8: return (value >= INT8_MIN) && (value <= INT8_MAX);
    case FMU_UINT8: return (value >= 0) && (value <= UINT8_MAX);
    case FMU_INT16: return (value >= INT16_MIN) && (value <= INT16_MAX);
    case FMU_UINT16: return (value >= 0) && (value <= UINT16_MAX);
    case FMU_INT32: return (value >= INT32_MIN) && (value <= INT32_MAX);
    case FMU_UINT32: return (value >= 0) && (value <= UINT32_MAX);
    case FMU_ENUMERATION: return (value >= 1) && (value <= of->literals);
    default: return true;
    }
}

bool fmu_set_integer(fmu_instance *self, uint32_t reference, int64_t value)
{
    const fmu_variable *const found = settable(self, reference);
    if (found == NULL) {
        return false;
    }
    if (!is_in_range(found, value)) {
        return fail_of_variable(self, reference, "does not have this value: it is out of range");
    }
    void *const at = place(self, found);
    switch (found->type) {
    case FMU_INT8: *(int8_t *)at = (int8_t)value; break;
    case FMU_UINT8: *(uint8_t *)at = (uint8_t)value; break;
    case FMU_INT16: *(int16_t *)at = (int16_t)value; break;
    case FMU_UINT16: *(uint16_t *)at = (uint16_t)value; break;
    case FMU_INT32: *(int32_t *)at = (int32_t)value; break;
    case FMU_UINT32: *(uint32_t *)at = (uint32_t)value; break;
    case FMU_INT64: *(int64_t *)at = value; break;
    case FMU_ENUMERATION: *(int *)at = (int)(value - 1); break;
    default: return fail_of_variable(self, reference, "is no integer");
    }
    return true;
}

bool fmu_get_boolean(fmu_instance *self, uint32_t reference, bool *value)
{
    const fmu_variable *const found = variable(self, reference);
    if (found == NULL) {
        return false;
    }
    if ((found->type != FMU_BOOLEAN) && (found->type != FMU_CLOCK)) {
        return fail_of_variable(self, reference, "is no truth value");
    }
    *value = *(bool *)place(self, found);
    return true;
}

bool fmu_set_boolean(fmu_instance *self, uint32_t reference, bool value)
{
    const fmu_variable *const found = settable(self, reference);
    if (found == NULL) {
        return false;
    }
    if ((found->type != FMU_BOOLEAN) && (found->type != FMU_CLOCK)) {
        return fail_of_variable(self, reference, "is no truth value");
    }
    *(bool *)place(self, found) = value;
    return true;
}
