/* SPDX-License-Identifier: 0BSD */
/* A RISC-V processor that a host serves: start after reset, faults, and the call of the host. With csp_port_board_riscv.ld. */
#include "csp_port_board.h"

#include <stddef.h>
#include <string.h>

/* Defined by the linker script. */
extern char csp_zero_begin[];
extern char csp_zero_end[];

void csp_reset(void);
void csp_board_prepare(void) __attribute__((used)); /* called in assembly alone, which -flto does not see */

/* The two shifts, which do nothing, mark the breakpoint between them as a call; none of the three may be a compressed instruction, or on another page. */
__attribute__((noinline, aligned(16))) intptr_t csp_board_call(uint32_t operation, const void *argument)
{
    register intptr_t result __asm__("a0") = (intptr_t)operation;
    register const void *const block __asm__("a1") = argument;
    __asm__ volatile(".option push\n\t"
                     ".option norvc\n\t"
                     "slli x0, x0, 0x1f\n\t"
                     "ebreak\n\t"
                     "srai x0, x0, 7\n\t"
                     ".option pop"
                     : "+r"(result)
                     : "r"(block)
                     : "memory");
    return result;
}

/* The handler of traps is at a multiple of 4 bytes, as the processor requires. */
__attribute__((naked, section(".start"))) void csp_reset(void)
{
    __asm__ volatile("la t0, 1f\n\t"
                     ".option push\n\t"
                     ".option arch, +zicsr\n\t"
                     "csrw mtvec, t0\n\t"
                     ".option pop\n\t"
                     "la tp, csp_thread_begin\n\t"
                     "la sp, csp_stack_end\n\t"
                     "j csp_board_prepare\n\t"
                     ".balign 4\n"
                     "1:\n\t"
                     "la sp, csp_stack_end\n\t"
                     "j csp_board_fault");
}

void csp_board_prepare(void)
{
    (void)memset(csp_zero_begin, 0, (size_t)(csp_zero_end - csp_zero_begin));
    csp_board_start();
}
