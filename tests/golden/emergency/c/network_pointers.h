/* SPDX-License-Identifier: 0BSD */
/* Where the pointers of struct network are. */
#ifndef NETWORK_POINTERS_H
#define NETWORK_POINTERS_H

#include "csp_saved.h"

/* How many structures are inside each other at most. */
#define CSP_NETWORK_DEPTH 6U
extern const csp_pointers network_pointers;

/* Some functions of the image: in another one, their distances are different. */
#define CSP_NETWORK_FUNCTIONS 3U
extern csp_function *const network_functions[CSP_NETWORK_FUNCTIONS];

#endif
