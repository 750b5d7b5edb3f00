"""Native programs that advance only by orders, and whose inputs may be taken over."""
