/* SPDX-License-Identifier: 0BSD */
#include "network.h"

/* Names are built in where communications are reported. */
#if CSP_TRACE
static void copy_name(const char *name, char *text, size_t size)
{
    size_t length = strlen(name);
    if (length >= size) {
        length = size - 1U;
    }
    (void)memcpy(text, name, length);
    text[length] = '\0';
}

static void process_name(uint32_t number, char *text, size_t size)
{
    copy_name(network_process_names[number], text, size);
}

static void channel_name(uint32_t number, char *text, size_t size)
{
    copy_name(network_channel_names[number], text, size);
}
#endif

static const char *const exception_names[] = {"Finished"};

const csp_program network_program = {
    .process = offsetof(struct network, top.process),
    .exception_names = exception_names,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};

void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks)
{
    csp_kernel *const csp = &self->kernel;
    csp_numbers numbers = {.csp = csp, .process = 1U, .channel = 0U};
    (void)memset(self, 0, sizeof(*self));
    csp_build(csp, &network_program, hooks);
    (void)drivers;
    commstime_initialize(&self->top, &numbers, 1000);
}
