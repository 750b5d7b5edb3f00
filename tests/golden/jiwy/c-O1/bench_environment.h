/* Both joints stand somewhere between their end stops; the operator moves the stick, presses the
 * button, lets go.
 *
 * Source: jiwy.csp:162
 */
#ifndef BENCH_ENVIRONMENT_H
#define BENCH_ENVIRONMENT_H

#include "network.h"

/* What is behind the ports of the program. */
extern const struct network_drivers bench_environment_drivers;
extern const csp_environment bench_environment;

#endif
