"""Control laws in C."""
