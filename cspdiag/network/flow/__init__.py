"""The control flow of a process: its composition as instructions with edges, and analyses of that graph."""
