"""What `cspdiag check` does besides showing findings."""
