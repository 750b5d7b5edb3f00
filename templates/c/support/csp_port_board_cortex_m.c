/* SPDX-License-Identifier: 0BSD */
/* A Cortex-M that a host serves: start after reset, faults, and the call of the host. With csp_port_board_cortex_m.ld. */
#include "csp_port_board.h"

#include <stddef.h>
#include <string.h>

/* Defined by the linker script. */
extern uint32_t csp_stack_end[];
extern uint32_t csp_data_begin[];
extern uint32_t csp_data_end[];
extern const uint32_t csp_data_in_flash[];
extern uint32_t csp_zero_begin[];
extern uint32_t csp_zero_end[];

#define COPROCESSORS (*(volatile uint32_t *)0xE000ED88U)

enum { FLOATING_POINT = 0xF << 20 };

void csp_reset(void);

intptr_t csp_board_call(uint32_t operation, const void *argument)
{
    register intptr_t result __asm__("r0") = (intptr_t)operation;
    register const void *const block __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(result) : "r"(block) : "memory");
    return result;
}

void csp_reset(void)
{
#ifdef __ARM_FP
    COPROCESSORS |= (uint32_t)FLOATING_POINT;
    __asm__ volatile("dsb\n\tisb");
#endif
    (void)memcpy(csp_data_begin, csp_data_in_flash, (size_t)((char *)csp_data_end - (char *)csp_data_begin));
    (void)memset(csp_zero_begin, 0, (size_t)((char *)csp_zero_end - (char *)csp_zero_begin));
    csp_board_start();
}

typedef void handler(void);

typedef struct vectors {
    uint32_t *stack;
    handler *reset;
    handler *exceptions[14]; /* 2 to 15 */
} vectors;

extern const vectors csp_vectors;
const vectors csp_vectors __attribute__((section(".vectors"), used)) = {
    csp_stack_end,
    csp_reset,
    {csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault,
     csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault, csp_board_fault},
};
