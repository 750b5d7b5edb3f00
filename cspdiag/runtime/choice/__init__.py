"""Guards, alternatives and interrupts."""
