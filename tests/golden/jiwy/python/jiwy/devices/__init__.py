"""Devices that the program names, copied from cspdiag."""
