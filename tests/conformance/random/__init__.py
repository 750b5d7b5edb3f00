"""Random programs that communicate often, on all targets: ``python -m tests.conformance.random``."""
