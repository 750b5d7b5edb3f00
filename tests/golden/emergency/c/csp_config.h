/* SPDX-License-Identifier: 0BSD */
/* What the program needs of the kernel. */
#ifndef CSP_CONFIG_H
#define CSP_CONFIG_H

#ifndef CSP_TRACE
#define CSP_TRACE 0 /* whether communications, processes and groups are observed */
#endif
#define CSP_LEVELS 1U /* of priority */

#include "csp_names.h"

#endif
