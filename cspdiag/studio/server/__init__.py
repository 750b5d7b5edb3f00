"""The server of ``cspdiag studio``: one page, its viewers, and the engines that work for them."""
