#include "network.h"

#include "constants.h"
#include "commstime.h"

/* All memory of the program. */
static struct commstime commstime;

void network_initialize(const struct network_drivers *drivers)
{
    csp_numbers numbers = {.process = 1U, .channel = 0U};
    csp_begin_building();
    (void)memset(&commstime, 0, sizeof(commstime));
    (void)drivers;
    commstime_initialize(&commstime, &numbers, 1000);
}

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
    .process = &commstime.process,
    .exception_names = exception_names,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};
