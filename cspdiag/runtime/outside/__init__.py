"""Where a program meets its environment: ports, drivers, their release."""
