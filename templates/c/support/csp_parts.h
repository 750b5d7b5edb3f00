/* SPDX-License-Identifier: 0BSD */
/* The parts of the kernel. A program defines those as 0 that it does not use (csp_config.h), and they take no memory then. */
#ifndef CSP_PARTS_H
#define CSP_PARTS_H

#include "csp_config.h"

/* ---- Channels, by their access ---- */

#ifndef CSP_USES_CHANNELS
#define CSP_USES_CHANNELS 1
#endif
#ifndef CSP_USES_GUARDED_CHANNELS
#define CSP_USES_GUARDED_CHANNELS 1
#endif
#ifndef CSP_USES_ANY_CHANNELS
#define CSP_USES_ANY_CHANNELS 1
#endif
#ifndef CSP_USES_BROADCASTS
#define CSP_USES_BROADCASTS 1
#endif
#ifndef CSP_USES_BUFFERS
#define CSP_USES_BUFFERS 1
#endif

/* ---- Ports of the outermost process ---- */

#ifndef CSP_USES_SAMPLED_INPUTS
#define CSP_USES_SAMPLED_INPUTS 1
#endif
#ifndef CSP_USES_EVENT_INPUTS
#define CSP_USES_EVENT_INPUTS 1
#endif
#ifndef CSP_USES_LATCHED_OUTPUTS
#define CSP_USES_LATCHED_OUTPUTS 1
#endif
#ifndef CSP_USES_ALIKE_PORTS
#define CSP_USES_ALIKE_PORTS 1 /* neighbours with the same ticks */
#endif
#define CSP_USES_INPUTS (CSP_USES_SAMPLED_INPUTS || CSP_USES_EVENT_INPUTS)

/* ---- Composition ---- */

#ifndef CSP_USES_ALTERNATIVES
#define CSP_USES_ALTERNATIVES 1
#endif
#ifndef CSP_USES_WIDE_ALTERNATIVES
#define CSP_USES_WIDE_ALTERNATIVES 1 /* of more guards than a word has bits */
#endif
#ifndef CSP_USES_TIME_OUTS
#define CSP_USES_TIME_OUTS 1 /* of alternatives and interrupts */
#endif
#ifndef CSP_USES_DELAYS
#define CSP_USES_DELAYS 1
#endif
#ifndef CSP_USES_OFFERS
#define CSP_USES_OFFERS 1 /* several communications of one process at the same time */
#endif
#ifndef CSP_USES_PARALLELS
#define CSP_USES_PARALLELS 1
#endif
#ifndef CSP_USES_INTERRUPTS
#define CSP_USES_INTERRUPTS 1
#endif
#define CSP_USES_CHOSEN_GUARDS (CSP_USES_ANY_CHANNELS || CSP_USES_BROADCASTS) /* by the process on the other side */
#define CSP_USES_OUTPUT_GUARDS (CSP_USES_CHOSEN_GUARDS || CSP_USES_BUFFERS)
#define CSP_USES_BRANCHES (CSP_USES_PARALLELS || CSP_USES_INTERRUPTS)

/* ---- Texts ---- */

/* The messages of faults. Without them a fault is reported with its place, but not with its values. Where a program is started by a person, by default. */
#ifndef CSP_USES_TEXTS
#if defined(__unix__) || defined(__APPLE__) || defined(_WIN32)
#define CSP_USES_TEXTS 1
#else
#define CSP_USES_TEXTS 0
#endif
#endif

#endif
