"""`csp_parts.h`: which parts of the kernel a program uses; the others are not compiled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

PARTS = "support/csp_parts.h"
"""The header, in which each part is used unless it says otherwise."""

_BEGUN_BY: Mapping[str, tuple[str, ...]] = {
    "CHANNELS": ("csp_channel_init(",),
    "GUARDED_CHANNELS": ("csp_guarded_init(",),
    "ANY_CHANNELS": ("csp_any_init(",),
    "BROADCASTS": ("csp_broadcast_init(",),
    "BUFFERS": ("csp_buffer_init(",),
    "SAMPLED_INPUTS": ("csp_sampled_input_init(",),
    "EVENT_INPUTS": ("csp_event_input_init(",),
    "LATCHED_OUTPUTS": ("csp_latched_output_init(",),
    "ALIKE_PORTS": (".alike =",),
    "ALTERNATIVES": ("csp_alternative_init(",),
    "WIDE_ALTERNATIVES": ("csp_word ",),
    "TIME_OUTS": ("csp_guard_after(",),
    "DELAYS": ("csp_wait(",),
    "OFFERS": ("csp_offers_init(",),
    "PARALLELS": ("csp_par(",),
    "INTERRUPTS": ("csp_interrupt_init(",),
}
"""For each part, the text of a program without which nothing of it exists at run time."""


def parts_header(text: str, sources: Iterable[str]) -> str:
    """The header for a program, from that of the kernel; ``sources`` are its sources and headers, by hand
    included."""
    program = "\n".join(sources)
    for part, functions in _BEGUN_BY.items():
        used = f"#define CSP_USES_{part} 1"
        assert used in text
        if not any(function in program for function in functions):
            text = text.replace(used, f"#define CSP_USES_{part} 0")
    return text
