"""Systems of equations: control laws and plants."""
