/* The environment Workshop.
 *
 * Source: emergency.csp:62
 */
#ifndef WORKSHOP_ENVIRONMENT_H
#define WORKSHOP_ENVIRONMENT_H

#include "network.h"

/* What is behind the ports of the program. */
extern const struct network_drivers workshop_environment_drivers;
extern const csp_environment workshop_environment;

#endif
