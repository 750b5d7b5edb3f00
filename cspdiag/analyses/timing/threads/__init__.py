"""The control flow of each thread of a program: where it computes, where it waits and for what."""
