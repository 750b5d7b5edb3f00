/* SPDX-License-Identifier: 0BSD */
/* Ports of hand-written processes. */
#include "csp_leaf.h"

#include "csp_text.h"

void csp_in_init(csp_in *in, csp_connection connection, csp_ends *ends)
{
    in->connection = connection;
    switch (connection.kind) {
    case CSP_END_BROADCAST:
        csp_broadcast_end_init(&in->end.broadcast, (csp_broadcast *)connection.at);
        in->medium = &in->end.broadcast.medium;
        break;
    case CSP_END_SAMPLED:
        csp_sampled_end_init(&in->end.sampled, (csp_sampled_input *)connection.at, ends);
        in->medium = &in->end.sampled.medium;
        break;
    case CSP_END_EVENT:
        in->connection.at = csp_event_reader(&in->end.event, (csp_event_input *)connection.at);
        in->medium = (csp_medium *)in->connection.at;
        break;
    case CSP_END_VARIABLE:
        in->medium = NULL;
        break;
    default:
        in->medium = (csp_medium *)connection.at;
        break;
    }
}

void csp_out_init(csp_out *out, csp_connection connection)
{
    out->connection = connection;
    out->medium = (connection.kind == CSP_END_VARIABLE) ? NULL : (csp_medium *)connection.at;
}

static void describe_size(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, "a variable of ");
    csp_append_integer(text, size, operands->integers[0]);
    csp_append(text, size, " bytes for values of ");
    csp_append_integer(text, size, operands->integers[1]);
}

/* Only the C compiler knows the types of a hand-written process; the kernel can at least check the size of a variable against that of a value. */
static bool fits(csp_kernel *csp, csp_party *party, const csp_connection *connection, size_t size)
{
    if (size == connection->size) {
        return true;
    }
    (void)csp_raise(csp, party, (uint16_t)CSP_FAULT_EXCEPTION, NULL);
    csp->error.describe = describe_size;
    csp->error.operands.integers[0] = (int64_t)size;
    csp->error.operands.integers[1] = (int64_t)connection->size;
    return false;
}

csp_progress csp_in_read(csp_kernel *csp, csp_party *party, csp_in *in, void *value, size_t size)
{
    void *const at = in->connection.at;
    if (!fits(csp, party, &in->connection, size)) {
        return CSP_FAILS;
    }
    if (in->connection.kind == CSP_END_VARIABLE) {
        (void)memcpy(value, at, size);
        return CSP_DONE;
    }
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    switch (in->connection.kind) {
    case CSP_END_CHANNEL:
        return csp_channel_read(csp, party, (csp_channel *)at, value, size);
    case CSP_END_GUARDED:
        return csp_guarded_read(csp, party, (csp_guarded_channel *)at, value, size);
    case CSP_END_ANY:
        return csp_any_read(csp, party, (csp_any_channel *)at, value, size);
    case CSP_END_BUFFER:
        return csp_buffer_read(csp, party, (csp_buffer *)at, value, size);
    case CSP_END_BROADCAST:
        return csp_broadcast_read(csp, party, &in->end.broadcast, value, size);
    case CSP_END_SAMPLED:
        return csp_sampled_read(csp, party, &in->end.sampled, value, size);
    default:
        return csp_event_read(csp, party, (csp_event_end *)at, value, size);
    }
}

csp_progress csp_in_read_again(csp_kernel *csp, csp_party *party, csp_in *in, void *value, size_t size)
{
    switch (in->connection.kind) {
    case CSP_END_SAMPLED:
        return csp_sampled_read_again(csp, party, &in->end.sampled, value, size);
    case CSP_END_EVENT:
        return csp_event_read_again(csp, party, (csp_event_end *)in->connection.at, value, size);
    default:
        return CSP_DONE;
    }
}

csp_progress csp_out_write(csp_kernel *csp, csp_party *party, csp_out *out, void *value, size_t size)
{
    void *const at = out->connection.at;
    if (!fits(csp, party, &out->connection, size)) {
        return CSP_FAILS;
    }
    if (out->connection.kind == CSP_END_VARIABLE) {
        if (at != NULL) {
            (void)memcpy(at, value, size);
        }
        return CSP_DONE;
    }
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    switch (out->connection.kind) {
    case CSP_END_CHANNEL:
        return csp_channel_write(csp, party, (csp_channel *)at, value, size);
    case CSP_END_GUARDED:
        return csp_guarded_write(csp, party, (csp_guarded_channel *)at, value, size);
    case CSP_END_ANY:
        return csp_any_write(csp, party, (csp_any_channel *)at, value, size);
    case CSP_END_BUFFER:
        return csp_buffer_write(csp, party, (csp_buffer *)at, value, size);
    case CSP_END_BROADCAST:
        return csp_broadcast_write(csp, party, (csp_broadcast *)at, value, size);
    case CSP_END_LATCHED:
        return csp_latched_write(party, (csp_latched_output *)at, value, size);
    default:
        return csp_direct_write(csp, party, (csp_direct_output *)at, value, size);
    }
}
