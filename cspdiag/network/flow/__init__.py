"""The control flow of a process: its composition as instructions with edges, and what is found by following them."""
