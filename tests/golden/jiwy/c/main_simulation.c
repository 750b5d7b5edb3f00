/* SPDX-License-Identifier: 0BSD */
/* The simulation of Jiwy: in virtual time, against the environments that are compiled in. */
#include "csp_simulation.h"
#include "network.h"
#include "bench_environment.h"
#include "worn_environment.h"

static struct network network;

static void connect_bench_environment(void)
{
    network_initialize(&network, &bench_environment_drivers, csp_port_hooks(), NULL);
}

static void connect_worn_environment(void)
{
    network_initialize(&network, &worn_environment_drivers, csp_port_hooks(), NULL);
}

static const csp_scenario scenarios[] = {
    {"Bench", &bench_environment, connect_bench_environment, false},
    {"Worn", &worn_environment, connect_worn_environment, false},
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
