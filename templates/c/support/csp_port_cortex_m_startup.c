/* What a Cortex-M does after reset: memory as C expects it, then main; and after a fault of the processor: safe values at the outputs.
 *
 * Interrupts of devices have their handlers in a table of your own behind that of the processor:
 *
 *     void (*const interrupts[])(void) __attribute__((section(".vectors.devices"), used)) = {[8] = on_timer};
 */
#include "csp_port.h"

#include <string.h>

#include "csp_program.h"

/* By the linker script csp_port_cortex_m.ld. */
extern uint32_t csp_stack_end[];
extern uint32_t csp_data_begin[];
extern uint32_t csp_data_end[];
extern const uint32_t csp_data_in_flash[];
extern uint32_t csp_zero_begin[];
extern uint32_t csp_zero_end[];

#define CONFIGURATION (*(volatile uint32_t *)0xE000ED14U)
#define HARD_FAULT_STATUS (*(volatile uint32_t *)0xE000ED2CU)

enum { TO_THREAD_FROM_ANY_LEVEL = 1, SEMIHOSTING_CALL = 0xBEAB, FRAME = 8, AT_PC = 6, AT_STATE = 7, THUMB = 1 << 24 };

enum { FAULT_STACK = 32 }; /* words of 64 bits */

#define NO_DEBUGGER (UINT32_C(1) << 31U) /* a breakpoint that nobody waits for */

int main(void);
void csp_reset(void);
/* Of the handler of faults, which is in assembly. */
extern uint64_t csp_fault_stack[];
uint64_t csp_fault_stack[FAULT_STACK];
void csp_fault_entry(uint32_t *frame);

void csp_reset(void)
{
    (void)memcpy(csp_data_begin, csp_data_in_flash, (size_t)((char *)csp_data_end - (char *)csp_data_begin));
    (void)memset(csp_zero_begin, 0, (size_t)((char *)csp_zero_end - (char *)csp_zero_begin));
    csp_port_exit(main() == 0);
}

/* In thread mode again, so that a device function that faults in here comes back by another fault, and the next output is released. */
static void after_fault(void)
{
    csp_release_outputs();
    csp_port_fatal("fault of the processor");
}

/* Nothing of what ran is left: the stack begins anew, for it may be the stack that is wrong. */
static void go_on_after_fault(void)
{
    uint32_t *volatile end = csp_stack_end; /* as the linker has it: no object, for the compiler */
    uint32_t *const frame = end - FRAME;
    (void)memset(frame, 0, FRAME * sizeof *frame);
    frame[AT_PC] = (uint32_t)(uintptr_t)after_fault & ~UINT32_C(1);
    frame[AT_STATE] = (uint32_t)THUMB;
    CONFIGURATION |= (uint32_t)TO_THREAD_FROM_ANY_LEVEL;
    __asm__ volatile("msr msp, %0\n\t"
                     "bx %1"
                     :
                     : "r"(frame), "r"(UINT32_C(0xFFFFFFF9)) /* to thread mode, with this stack */
                     : "memory");
}

void csp_fault_entry(uint32_t *frame)
{
    if ((HARD_FAULT_STATUS & NO_DEBUGGER) != 0U) {
        HARD_FAULT_STATUS = NO_DEBUGGER;
        if (*(const uint16_t *)(uintptr_t)frame[AT_PC] == (uint16_t)SEMIHOSTING_CALL) {
            frame[AT_PC] += 2U; /* the text is for a debugger, and there is none */
            return;
        }
    }
    go_on_after_fault();
}

/* Also of interrupts that no handler is there for. It has a stack of its own, and hands over what the processor has put on the other. */
__attribute__((naked)) static void fault(void)
{
    __asm__ volatile("tst lr, #4\n\t"
                     "ite eq\n\t"
                     "mrseq r0, msp\n\t"
                     "mrsne r0, psp\n\t"
                     "mov r1, sp\n\t"
                     "ldr r2, =csp_fault_stack + %c0\n\t"
                     "mov sp, r2\n\t"
                     "push {r1, lr}\n\t"
                     "bl csp_fault_entry\n\t"
                     "pop {r1, lr}\n\t"
                     "mov sp, r1\n\t"
                     "bx lr\n\t"
                     ".ltorg"
                     :
                     : "i"(FAULT_STACK * sizeof(uint64_t)));
}

typedef void handler(void);

typedef struct vectors {
    uint32_t *stack;
    handler *reset;
    handler *exceptions[13]; /* 2 to 14 */
    handler *tick;
} vectors;

extern const vectors csp_vectors;
const vectors csp_vectors __attribute__((section(".vectors"), used)) = {
    csp_stack_end,
    csp_reset,
    {fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault},
    csp_port_tick,
};
