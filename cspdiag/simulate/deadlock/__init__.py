"""The account of a deadlock, the same for runs in Python, native runs and runs on the reference semantics."""
