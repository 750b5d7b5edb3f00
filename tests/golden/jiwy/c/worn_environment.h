/* A worn machine, its friction up by 30 %, switched on near its end stops, in the hand of an
 * impatient operator.
 *
 * Source: jiwy.csp:183
 */
#ifndef WORN_ENVIRONMENT_H
#define WORN_ENVIRONMENT_H

#include "network.h"

/* What is behind the ports of the program. */
extern const struct network_drivers worn_environment_drivers;
extern const csp_environment worn_environment;

#endif
