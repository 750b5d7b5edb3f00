"""Every philosopher takes the left fork first: all hold one fork and wait for the other."""
