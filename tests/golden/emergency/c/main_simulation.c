/* SPDX-License-Identifier: 0BSD */
/* The simulation of Spindle: in virtual time, against the environments that are compiled in. */
#include "csp_simulation.h"
#include "network.h"
#include "workshop_environment.h"

static struct network network;

static void connect_workshop_environment(void)
{
    network_initialize(&network, &workshop_environment_drivers, csp_port_hooks());
}

static const csp_scenario scenarios[] = {
    {"Workshop", &workshop_environment, connect_workshop_environment, false},
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
