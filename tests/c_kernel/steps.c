/* Counts the basic blocks that files compiled with -fsanitize-coverage=trace-pc execute; this one is compiled without. */
#include <stdint.h>

uint64_t steps_taken;

void __sanitizer_cov_trace_pc(void);

void __sanitizer_cov_trace_pc(void)
{
    steps_taken++;
}
