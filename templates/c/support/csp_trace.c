/* SPDX-License-Identifier: 0BSD */
/* Communications for the owner of a run: see the hook `trace`. Simulations observe in csp_stream.c. */
#include "csp_internal.h"

#if CSP_TRACE_HOOK && CSP_TRACE
#error "communications are reported either to csp_observe (CSP_TRACE) or to the hook `trace` (CSP_TRACE_HOOK)"
#endif

#if CSP_TRACE_HOOK

void csp_call_trace(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    const csp_hooks *const hooks = csp->hooks;
    if ((hooks != NULL) && (hooks->trace != NULL)) {
        hooks->trace(hooks->context, channel, value, writer, reader);
    }
}

#endif
