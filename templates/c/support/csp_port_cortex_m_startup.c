/* What a Cortex-M does after reset: memory as C expects it, then main. Interrupts of devices are added to the vectors here. */
#include "csp_port.h"

#include <string.h>

/* By the linker script csp_port_cortex_m.ld. */
extern uint32_t csp_stack_end[];
extern uint32_t csp_data_begin[];
extern uint32_t csp_data_end[];
extern const uint32_t csp_data_in_flash[];
extern uint32_t csp_zero_begin[];
extern uint32_t csp_zero_end[];

int main(void);
void csp_reset(void);

void csp_reset(void)
{
    (void)memcpy(csp_data_begin, csp_data_in_flash, (size_t)((char *)csp_data_end - (char *)csp_data_begin));
    (void)memset(csp_zero_begin, 0, (size_t)((char *)csp_zero_end - (char *)csp_zero_begin));
    csp_port_exit(main() == 0);
}

static void unexpected(void)
{
    csp_port_fatal("unexpected exception of the processor");
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
    {unexpected, unexpected, unexpected, unexpected, unexpected, unexpected, unexpected, unexpected, unexpected,
     unexpected, unexpected, unexpected, unexpected},
    csp_port_tick,
};
