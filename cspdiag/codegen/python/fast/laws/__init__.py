"""Inlined control laws and environments: assignments within the code of the process that runs them."""
