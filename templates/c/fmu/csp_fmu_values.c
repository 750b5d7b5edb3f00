/* See csp_fmu_library.h: the values of variables, converted to and from the types of the FMU. */
#include "csp_fmu_library.h"

#include <string.h>

typedef int access_function(void *c, const uint32_t *references, size_t count, void *values);
typedef int access3_function(void *c, const uint32_t *references, size_t count, void *values, size_t value_count);

static bool is_real(csp_fmu_type type)
{
    return (type == CSP_FMU_FLOAT64) || (type == CSP_FMU_FLOAT32);
}

static double real_of(const csp_fmu_value *from, csp_fmu_type type)
{
    return (type == CSP_FMU_FLOAT32) ? (double)from->f32 : from->f64;
}

static int64_t integer_of(const csp_fmu_value *from, csp_fmu_type type)
{
    switch (type) {
    case CSP_FMU_INT8: return from->i8;
    case CSP_FMU_UINT8: return from->u8;
    case CSP_FMU_INT16: return from->i16;
    case CSP_FMU_UINT16: return from->u16;
    case CSP_FMU_INT32: return from->i32;
    case CSP_FMU_UINT32: return from->u32;
    case CSP_FMU_BOOL: return from->b ? 1 : 0;
    case CSP_FMU_BOOLEAN: return (from->boolean != 0) ? 1 : 0;
    default: return from->i64;
    }
}

static void store_integer(csp_fmu_value *to, csp_fmu_type type, int64_t number)
{
    switch (type) {
    case CSP_FMU_INT8: to->i8 = (int8_t)number; break;
    case CSP_FMU_UINT8: to->u8 = (uint8_t)number; break;
    case CSP_FMU_INT16: to->i16 = (int16_t)number; break;
    case CSP_FMU_UINT16: to->u16 = (uint16_t)number; break;
    case CSP_FMU_INT32: to->i32 = (int32_t)number; break;
    case CSP_FMU_UINT32: to->u32 = (uint32_t)number; break;
    case CSP_FMU_BOOL: to->b = number != 0; break;
    case CSP_FMU_BOOLEAN: to->boolean = (int)number; break;
    default: to->i64 = number; break;
    }
}

size_t csp_fmu_size_of(csp_fmu_type type)
{
    static const size_t sizes[] = {8U, 4U, 1U, 1U, 2U, 2U, 4U, 4U, 8U, sizeof(bool), sizeof(int)};
    return sizes[type];
}

static void convert(const csp_fmu_value *from, csp_fmu_type old, csp_fmu_value *to, csp_fmu_type type)
{
    if (!is_real(old)) {
        store_integer(to, type, integer_of(from, old));
    } else if (type == CSP_FMU_FLOAT32) {
        to->f32 = (float)real_of(from, old);
    } else {
        to->f64 = real_of(from, old);
    }
}

static bool access_value(csp_fmu *self, void *function, const csp_fmu_port *port, csp_fmu_value *of, const char *action, double time)
{
    int status = (int)CSP_FMU_DISCARD;
    if (function == NULL) {
        return csp_fmu_fail(self, "has no function %s%s", action, port->functions);
    }
    if (self->facts->is_new) {
        access3_function *found = NULL;
        *(void **)&found = function;
        status = found(self->library->component, &port->reference, 1U, of, 1U);
    } else {
        access_function *found = NULL;
        *(void **)&found = function;
        status = found(self->library->component, &port->reference, 1U, of);
    }
    return csp_fmu_is_fine(self, status, action, time);
}

bool csp_fmu_set(csp_fmu *self, void *function, const csp_fmu_port *port, const void *ports, double time)
{
    csp_fmu_value member = {0};
    csp_fmu_value given = {0};
    (void)memcpy(&member, (const char *)ports + port->offset, csp_fmu_size_of(port->member));
    convert(&member, port->member, &given, port->type);
    return access_value(self, function, port, &given, "Set", time);
}

bool csp_fmu_set_all(csp_fmu *self, const csp_fmu_port *table, size_t count, const void *ports, double time)
{
    for (size_t index = 0U; index < count; index++) {
        if (!csp_fmu_set(self, csp_fmu_find(self, "Set", table[index].functions), &table[index], ports, time)) {
            return false;
        }
    }
    return true;
}

bool csp_fmu_get_outputs(csp_fmu *self, void *ports, double time)
{
    for (size_t index = 0U; index < self->facts->output_count; index++) {
        const csp_fmu_port *const port = &self->facts->outputs[index];
        csp_fmu_value taken = {0};
        csp_fmu_value member = {0};
        if (!access_value(self, self->library->getters[index], port, &taken, "Get", time)) {
            return false;
        }
        convert(&taken, port->type, &member, port->member);
        (void)memcpy((char *)ports + port->offset, &member, csp_fmu_size_of(port->member));
    }
    return true;
}
