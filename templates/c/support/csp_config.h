/* SPDX-License-Identifier: 0BSD */
/* The configuration of the kernel for a program; generated packages have their own. */
#ifndef CSP_CONFIG_H
#define CSP_CONFIG_H

#ifndef CSP_TRACE
#define CSP_TRACE 0 /* whether communications, processes and groups are reported to csp_observe... */
#endif
#ifndef CSP_LEVELS
#define CSP_LEVELS 1U /* levels of priority */
#endif

#endif
