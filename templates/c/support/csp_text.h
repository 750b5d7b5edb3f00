/* Texts for people, without a heap: printf and strtod of small machines need one. */
#ifndef CSP_TEXT_H
#define CSP_TEXT_H

#include <stddef.h>
#include <stdint.h>

/* Appends to a text of at most `size` characters with the 0 that ends it, as much as fits. */
void csp_append(char *text, size_t size, const char *more);
/* A number in at least so many decimal digits. */
void csp_append_digits(char *text, size_t size, uint64_t value, int least);
void csp_append_integer(char *text, size_t size, int64_t value);
/* As every target writes reals, in the fewest digits that are read as the same number: 0.5, 1e+16, -2.0, nan. */
void csp_append_real(char *text, size_t size, double value);

#endif
