/* SPDX-License-Identifier: 0BSD */
/* The simulation of Commstime: in virtual time, against the environments that are compiled in. */
#include "csp_simulation.h"
#include "network.h"

static struct network network;

static void connect_nothing(void)
{
    static const struct network_drivers drivers;
    network_initialize(&network, &drivers, csp_port_hooks());
}

static const csp_scenario scenarios[] = {
    {"", NULL, connect_nothing, false},
};

#if CSP_TRACE
#define NAMES                                                                                      \
    {network_channel_count, network_channel_names, network_channel_sizes,                          \
     network_process_count, network_process_names, network_process_kinds}
#else
#define NAMES {0, NULL, NULL, 0, NULL, NULL}
#endif

int main(int count, char **options)
{
    const csp_names names = NAMES;
    const uint32_t scenario_count = (uint32_t)(sizeof scenarios / sizeof scenarios[0]);
    return csp_simulate(count, options, &network.kernel, &names, scenarios, scenario_count);
}
