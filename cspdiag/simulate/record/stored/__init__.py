"""Recordings that are read: of runs of cspdiag, whole or cut, in any of their formats."""
