/* SPDX-License-Identifier: 0BSD */
/* The start of a Cortex-M after reset: initializes memory as C requires, then calls main. After a fault of the processor, exit, abort or a failed
 * assertion, it sets the outputs to their safe values.
 *
 * The handlers of device interrupts are in a table of your own, which is placed after that of the processor, and is as long as the processor has
 * interrupts: one without a handler is a fault.
 *
 *     void (*const interrupts[32])(void) __attribute__((section(".vectors.devices"), used)) = {[8] = on_timer};
 */
#include "csp_port.h"

#include <string.h>

#include "csp_program.h"

/* Defined by the linker script csp_port_cortex_m.ld. */
extern uint32_t csp_stack_end[];
extern uint32_t csp_data_begin[];
extern uint32_t csp_data_end[];
extern const uint32_t csp_data_in_flash[];
extern uint32_t csp_zero_begin[];
extern uint32_t csp_zero_end[];
extern uint32_t csp_stack_guard[] __attribute__((weak)); /* the beginning of the guarded region below the stack; may be undefined */

#define CONFIGURATION (*(volatile uint32_t *)0xE000ED14U)
#define HARD_FAULT_STATUS (*(volatile uint32_t *)0xE000ED2CU)
#define COPROCESSORS (*(volatile uint32_t *)0xE000ED88U)
#define FLOATING_POINT_CONTEXT (*(volatile uint32_t *)0xE000EF34U)
#define PROTECTION_TYPE (*(volatile uint32_t *)0xE000ED90U)
#define PROTECTION_CONTROL (*(volatile uint32_t *)0xE000ED94U)
#define PROTECTION_REGION (*(volatile uint32_t *)0xE000ED98U)
#define PROTECTION_BASE (*(volatile uint32_t *)0xE000ED9CU)
#define PROTECTION_ATTRIBUTES (*(volatile uint32_t *)0xE000EDA0U)
#define DISABLED_INTERRUPTS ((volatile uint32_t *)0xE000E180U)

enum { REGIONS = 0xFF00, PROTECTS = 1, OTHERWISE_AS_USUAL = 4, NO_ACCESS = 1 << 28, OF_64_KIB = 15 << 1, IN_FORCE = 1 };

enum { FLOATING_POINT = 0xF << 20, KEEPS_CONTEXT = 1, OF_HANDLER = 0x1FF };

enum { TO_THREAD_FROM_ANY_LEVEL = 1, SEMIHOSTING_CALL = 0xBEAB, FRAME = 8, AT_PC = 6, AT_STATE = 7, THUMB = 1 << 24 };

enum { FAULT_STACK = 32 /* words of 64 bits */, GUARDED = 64 * 1024 /* bytes below the stack */ };

#define NO_DEBUGGER (UINT32_C(1) << 31U) /* a breakpoint without a debugger */

/* Processors of ARMv6-M, as Cortex-M0, do not say why a fault has happened, and return to thread mode only when all handlers have returned. */
#ifdef __ARM_ARCH_6M__
#define HAS_ARMV7 0
#else
#define HAS_ARMV7 1
#endif

enum { INTERRUPT_WORDS = (HAS_ARMV7 != 0) ? 8 : 1 }; /* of 32 interrupts each */

int main(void);
void csp_reset(void);
/* What -flto does not see: that assembly or the library needs something. */
#define USED __attribute__((used))

/* The stack of the fault handler, which is in assembly, and what it calls. */
extern uint64_t csp_fault_stack[];
USED uint64_t csp_fault_stack[FAULT_STACK];
USED void csp_fault_entry(uint32_t *frame);
/* Called at the end of exit, abort and assert of the library. */
USED void _exit(int status);
USED void abort(void);
USED void __assert_func(const char *file, int line, const char *function, const char *expression);

static volatile bool successful; /* the status of an exit in an interrupt handler */
static volatile uint32_t faulted_at;

/* Makes writes below the stack fault, if the processor has a memory protection unit. */
static void guard_stack(void)
{
#if HAS_ARMV7
    if ((csp_stack_guard != NULL) && ((PROTECTION_TYPE & (uint32_t)REGIONS) != 0U)) {
        PROTECTION_REGION = 0U;
        PROTECTION_BASE = (uint32_t)(uintptr_t)csp_stack_guard;
        PROTECTION_ATTRIBUTES = (uint32_t)NO_ACCESS | (uint32_t)OF_64_KIB | (uint32_t)IN_FORCE;
        PROTECTION_CONTROL = (uint32_t)PROTECTS | (uint32_t)OTHERWISE_AS_USUAL;
        __asm__ volatile("dsb\n\tisb");
    }
#endif
}

void csp_reset(void)
{
    guard_stack();
#ifdef __ARM_FP
    COPROCESSORS |= (uint32_t)FLOATING_POINT;
    __asm__ volatile("dsb\n\tisb");
#endif
    (void)memcpy(csp_data_begin, csp_data_in_flash, (size_t)((char *)csp_data_end - (char *)csp_data_begin));
    (void)memset(csp_zero_begin, 0, (size_t)((char *)csp_zero_end - (char *)csp_zero_begin));
    csp_port_exit(main() == 0);
}

uint32_t csp_port_faulted_at(void)
{
    return faulted_at;
}

__attribute__((weak)) void csp_port_release(void)
{
    csp_release_outputs(csp_owned());
}

/* Runs in thread mode: if a device function faults here, this function is started again, and the next output is released. */
static void after_fault(void)
{
    csp_port_release();
    csp_port_fatal("fault of the processor");
}

static void after_exit(void)
{
    csp_port_release();
    csp_port_exit(successful);
}

/* Goes to a function, or returns from the exception, with another stack. */
__attribute__((noreturn)) static void go_to(uint32_t address, const uint32_t *stack)
{
    __asm__ volatile("dsb\n\t"
                     "msr control, %2\n\t" /* privileged */
                     "isb\n\t"
                     "cpsie i\n\t"
                     "msr msp, %0\n\t"
                     "bx %1"
                     :
                     : "r"(stack), "r"(address), "r"(0U)
                     : "memory");
    __builtin_unreachable();
}

/* Discards everything that was running: the stack is reset, because it may be corrupt. Interrupts of devices are disabled, because one without
 * a handler would recur forever. The timer interrupt stays enabled. */
__attribute__((noreturn)) static void restart_with(void (*function)(void))
{
    uint32_t *volatile end = csp_stack_end; /* an address from the linker, which the compiler must not take for an object */
    uint32_t *const frame = end - FRAME;
    for (uint32_t word = 0U; word < (uint32_t)INTERRUPT_WORDS; word++) {
        DISABLED_INTERRUPTS[word] = UINT32_MAX;
    }
    (void)memset(frame, 0, FRAME * sizeof *frame);
    frame[AT_PC] = (uint32_t)(uintptr_t)function & ~UINT32_C(1);
    frame[AT_STATE] = (uint32_t)THUMB;
#if HAS_ARMV7
    CONFIGURATION |= (uint32_t)TO_THREAD_FROM_ANY_LEVEL;
    FLOATING_POINT_CONTEXT &= ~(uint32_t)KEEPS_CONTEXT; /* it would be saved on the old stack */
    __asm__ volatile("msr basepri, %0" : : "r"(0U) : "memory");
#endif
    go_to(UINT32_C(0xFFFFFFF9), frame); /* to thread mode, with this stack */
}

/* Leaves the interrupt handler first, because device functions could not wait for the clock in it. */
void _exit(int status)
{
    uint32_t exception = 0U;
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    successful = status == 0;
    if ((HAS_ARMV7 != 0) && ((exception & (uint32_t)OF_HANDLER) != 0U)) {
        restart_with(after_exit);
    }
    after_exit();
    for (;;) {
        /* Does not return. */
    }
}

/* Replaces that of the library, which looks for signal handlers and uses a heap for them. */
void abort(void)
{
    csp_port_write("abort\n");
    _exit(1);
    for (;;) {
        /* Does not return. */
    }
}

void __assert_func(const char *file, int line, const char *function, const char *expression)
{
    char number[12];
    size_t at = sizeof number - 1U;
    uint32_t rest = (uint32_t)line;
    (void)function;
    number[at] = '\0';
    do {
        at--;
        number[at] = (char)('0' + (char)(rest % 10U));
        rest /= 10U;
    } while (rest > 0U);
    csp_port_write(file);
    csp_port_write(":");
    csp_port_write(&number[at]);
    csp_port_write(": not so: ");
    csp_port_write(expression);
    csp_port_write("\n");
    _exit(1);
    for (;;) {
        /* Does not return. */
    }
}

/* Whether it is a text for a debugger, and there is none. */
static bool is_unheard(const uint32_t *frame)
{
#if HAS_ARMV7
    if ((HARD_FAULT_STATUS & NO_DEBUGGER) == 0U) {
        return false;
    }
    HARD_FAULT_STATUS = NO_DEBUGGER;
#else
    /* An address that is none of the program's must not be read: a second fault would stop the processor. */
    if (((frame[AT_PC] % 2U) != 0U) || (frame[AT_PC] >= (uint32_t)(uintptr_t)csp_data_in_flash)) {
        return false;
    }
#endif
    return *(const uint16_t *)(uintptr_t)frame[AT_PC] == (uint16_t)SEMIHOSTING_CALL;
}

/* Whether the frame is on the stack, not below it: there is no memory. */
static bool is_on_stack(const uint32_t *frame)
{
    const uint32_t *volatile end = csp_stack_end;
    const char *const begin = (const char *)csp_stack_guard + GUARDED;
    return (csp_stack_guard != NULL) && ((const char *)frame >= begin) && (frame < end);
}

void csp_fault_entry(uint32_t *frame)
{
    if (is_unheard(frame)) {
        frame[AT_PC] += 2U;
        return;
    }
    if ((faulted_at == 0U) && is_on_stack(frame)) {
        faulted_at = frame[AT_PC];
    }
    if ((HAS_ARMV7 == 0) && ((frame[AT_STATE] & (uint32_t)OF_HANDLER) != 0U)) {
        /* In this handler, because that of the interrupt would have to return first, with all of the stack, because device functions need it. */
        go_to((uint32_t)(uintptr_t)after_fault, csp_stack_end);
    }
    restart_with(after_fault);
}

/* Also the handler of interrupts that have none. It has a stack of its own, and passes on the frame that the processor has pushed onto the other. */
__attribute__((naked)) static void fault(void)
{
    __asm__ volatile("mrs r0, msp\n\t"
                     "mov r1, lr\n\t"
                     "movs r2, #4\n\t"
                     "tst r1, r2\n\t"
                     "beq 1f\n\t"
                     "mrs r0, psp\n"
                     "1:\n\t"
                     "mov r1, sp\n\t"
                     "ldr r2, =csp_fault_stack + %c0\n\t"
                     "mov sp, r2\n\t"
                     "push {r1, lr}\n\t"
                     "bl csp_fault_entry\n\t"
                     "pop {r1, r2}\n\t"
                     "mov sp, r1\n\t"
                     "bx r2\n\t"
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
