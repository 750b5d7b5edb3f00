/* SPDX-License-Identifier: 0BSD */
/* The messages of faults, worded as in every target. Each function writes at most `size` characters, including the terminating 0. */
#ifndef CSP_FAULT_TEXT_H
#define CSP_FAULT_TEXT_H

#include "csp_core.h"

void csp_describe_sum(const csp_operands *operands, char *text, size_t size);
void csp_describe_difference(const csp_operands *operands, char *text, size_t size);
void csp_describe_product(const csp_operands *operands, char *text, size_t size);
void csp_describe_division(const csp_operands *operands, char *text, size_t size);
void csp_describe_real_division(const csp_operands *operands, char *text, size_t size);
void csp_describe_negative_exponent(const csp_operands *operands, char *text, size_t size);
void csp_describe_power(const csp_operands *operands, char *text, size_t size);
void csp_describe_power_value(const csp_operands *operands, char *text, size_t size);
void csp_describe_outside(const csp_operands *operands, char *text, size_t size);
void csp_describe_real_outside(const csp_operands *operands, char *text, size_t size);
void csp_describe_index(const csp_operands *operands, char *text, size_t size);
void csp_describe_not_a_number(const csp_operands *operands, char *text, size_t size);
void csp_describe_not_finite(const csp_operands *operands, char *text, size_t size);
void csp_describe_enumerator(const csp_operands *operands, char *text, size_t size);
void csp_describe_not_written(const csp_operands *operands, char *text, size_t size);
void csp_describe_not_opened(const csp_operands *operands, char *text, size_t size);

#endif
