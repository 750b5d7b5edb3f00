"""The functions of the kernel that are passed the kernel itself, the state of a run, as their first argument."""

from __future__ import annotations

_FUNCTIONS = """
    csp_absolute csp_add csp_any_read csp_any_write csp_broadcast_read csp_broadcast_write csp_buffer_read
    csp_buffer_write csp_catch csp_channel_read csp_channel_write csp_device_refused csp_direct_write csp_divide
    csp_divide_single csp_end csp_enumerator csp_event_read csp_event_read_again csp_fail csp_fault_in csp_faulted
    csp_faulted_at csp_finite csp_finite_at csp_finite_single csp_guarded_read csp_guarded_write csp_index csp_int16
    csp_int16_of_real csp_int32 csp_int32_of_real csp_int64_of_real csp_int8 csp_int8_of_real csp_interruptible
    csp_interruptible_again csp_multiply csp_negate csp_not_written csp_observe csp_observe_begin csp_observe_end
    csp_observe_loop csp_observe_release csp_observe_sample csp_offer_made csp_offer_meets csp_offer_refused
    csp_offers_begin csp_offers_give_up csp_overwritten csp_par csp_par_again csp_power csp_quotient csp_raise
    csp_raise_fault csp_raised csp_raised_in csp_real csp_real_single csp_refused csp_remainder csp_require_written
    csp_sampled_read csp_sampled_read_again csp_select csp_select_again csp_select_inputs csp_stop csp_subtract
    csp_time_absolute csp_time_add csp_time_multiply csp_time_negate csp_time_quotient csp_time_subtract csp_uint16
    csp_uint16_of_real csp_uint32 csp_uint32_of_real csp_uint8 csp_uint8_of_real csp_unwind csp_wait
"""
TAKES_KERNEL = frozenset(_FUNCTIONS.split())
"""Every function that may wake a process, raise an exception, note a fault or report. ``call`` adds the argument."""

_MACROS = """
    CSP_AWAIT CSP_OFFER CSP_REPORT
"""
USES_KERNEL = frozenset(_MACROS.split())
"""Macros that use the variable ``csp``."""

KERNEL = "csp_kernel *csp"
"""The parameter."""
