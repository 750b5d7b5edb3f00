/* SPDX-License-Identifier: 0BSD */
/* Texts for users, without a heap, which printf and strtod of small machines need. */
#ifndef CSP_TEXT_H
#define CSP_TEXT_H

#include <stddef.h>
#include <stdint.h>

#include "csp_config.h"

/* Appends as much as fits to a text of at most `size` characters, including the terminating 0. */
void csp_append(char *text, size_t size, const char *more);
/* Appends a number with at least `least` decimal digits. */
void csp_append_digits(char *text, size_t size, uint64_t value, int least);
void csp_append_integer(char *text, size_t size, int64_t value);
/* Appends a real as in every target, with the fewest digits that are read as the same number: 0.5, 1e+16, -2.0, nan. */
void csp_append_real(char *text, size_t size, double value);

#endif
