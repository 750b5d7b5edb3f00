"""The behaviour of threads: what each computes from one wait to the next, and which samples it follows."""
