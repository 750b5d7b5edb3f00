"""The resident server of ``cspdiag check --server``: it keeps the compiler and what it has read in memory.

``client`` is the command, ``resident`` the server, which forks a process per command (``request``). ``place`` and
``messages`` are what both ends agree on; the client loads nothing else, to be fast.
"""
