/* SPDX-License-Identifier: 0BSD */
/* Channels with memory between one writer and one reader. A value communicates when it enters.
 *
 * While the reader waits, nothing is stored; while the writer waits, the buffer is full.
 */
#include "csp_internal.h"

void csp_buffer_init(csp_buffer *buffer, uint32_t number, void *values, uint32_t capacity, bool overwrites)
{
    buffer->medium.number = number;
    buffer->medium.kind = (uint8_t)CSP_BUFFER;
    buffer->values = (unsigned char *)values;
    buffer->capacity = capacity;
    buffer->overwrites = overwrites;
}

static void enter(csp_kernel *csp, uint32_t writer, csp_buffer *buffer, const void *value, size_t size)
{
    if (buffer->reader != NULL) {
        csp_copy(buffer->reader->slot, value, size);
        csp_ready(csp, buffer->reader);
        buffer->reader = NULL;
    } else {
        uint32_t place = buffer->first + buffer->stored;
        if (place >= buffer->capacity) {
            place -= buffer->capacity;
        }
        csp_copy(&buffer->values[place * size], value, size);
        buffer->stored++;
        csp_raise_bits(csp, buffer->inputs);
        if ((buffer->stored == buffer->capacity) && !buffer->overwrites) {
            csp_lower_bits(buffer->outputs);
        }
    }
    csp_observe(csp, buffer->medium.number, value, writer, 0U);
}

static void drop_first(csp_buffer *buffer)
{
    buffer->first++;
    if (buffer->first == buffer->capacity) {
        buffer->first = 0U;
    }
    buffer->stored--;
}

void csp_buffer_take(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size)
{
    (void)party;
    csp_copy(value, &buffer->values[buffer->first * size], size);
    drop_first(buffer);
    if (buffer->writer != NULL) {
        csp_party *const writer = buffer->writer;
        buffer->writer = NULL;
        csp_ready(csp, writer);
        enter(csp, writer->number, buffer, writer->slot, size);
    } else {
        csp_raise_bits(csp, buffer->outputs);
    }
    if (buffer->stored == 0U) {
        csp_lower_bits(buffer->inputs);
    }
}

csp_progress csp_buffer_read(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size)
{
    if (buffer->stored > 0U) {
        csp_buffer_take(csp, party, buffer, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    buffer->reader = party;
    return CSP_WAITS;
}

csp_progress csp_buffer_write(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size)
{
    if ((buffer->reader == NULL) && (buffer->stored == buffer->capacity)) {
        if (!buffer->overwrites) {
            party->slot = value;
            buffer->writer = party;
            return CSP_WAITS;
        }
        drop_first(buffer);
    }
    enter(csp, party->number, buffer, value, size);
    return CSP_DONE;
}
