"""The control-flow graph of each thread of a program: where it computes, where it waits, and for what."""
